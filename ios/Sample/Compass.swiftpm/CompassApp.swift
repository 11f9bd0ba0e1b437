import Magcomp
import SwiftUI

@main
struct CompassApp: App {
    // the system's own field too, to show it beside ours
    @State private var model = CompassModel(
        compass: Compass(
            source: CoreMotionSource(options: SensorOptions(systemField: true)), store: UserDefaultsStore()))

    @Environment(\.scenePhase) private var phase

    var body: some Scene {
        WindowGroup { CompassView(model: model) }
            .onChange(of: phase) {
                // iOS may end an app in the background without a word
                if phase == .background { model.save() }
            }
    }
}
