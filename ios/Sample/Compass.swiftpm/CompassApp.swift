import Magcomp
import SwiftUI

@main
struct CompassApp: App {
    /// The phone's sensors; nil in the Simulator, which has none.
    private let source: CoreMotionSource?
    @State private var model: CompassModel

    @Environment(\.scenePhase) private var phase

    init() {
        #if targetEnvironment(simulator)
        source = nil
        model = CompassModel()
        #else
        // the system's own field too, to show it beside ours; an app that shows no lag has CompassModel() here as well
        let sensors = CoreMotionSource(options: CoreMotionSource.Options(systemField: true))
        source = sensors
        model = CompassModel(compass: Compass(source: sensors, store: UserDefaultsStore()))
        #endif
    }

    var body: some Scene {
        WindowGroup { CompassView(model: model, source: source) }
            .onChange(of: phase) {
                // iOS may end an app in the background without a word
                if phase == .background { model.save() }
            }
    }
}
