import Magcomp
import SwiftUI

@main
struct CompassApp: App {
    private let source: CoreMotionSource
    @State private var model: CompassModel

    @Environment(\.scenePhase) private var phase

    init() {
        // the system's own field too, to show it beside ours
        source = CoreMotionSource(options: SensorOptions(systemField: true))
        model = CompassModel(compass: Compass(source: source, store: UserDefaultsStore()))
    }

    var body: some Scene {
        WindowGroup { CompassView(model: model, source: source) }
            .onChange(of: phase) {
                // iOS may end an app in the background without a word
                if phase == .background { model.save() }
            }
    }
}
