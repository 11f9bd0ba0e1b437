import Magcomp
import SwiftUI

struct CompassView: View {
    @State private var model = CompassModel()
    @Environment(\.scenePhase) private var phase

    var body: some View {
        VStack {
            CompassRose(headingDeg: model.headingDeg, sigmaDeg: model.headingSigmaDeg)
            CompassAdvice(model)
        }
        .compassScreen(model.compass)
        .task { await model.run() }
        .onChange(of: phase) { if phase == .background { model.save() } }
    }
}
