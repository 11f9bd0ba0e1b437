import Magcomp
import SwiftUI

struct CompassView: View {
    @State private var model = CompassModel()

    var body: some View {
        VStack {
            CompassRose(headingDeg: model.headingDeg, sigmaDeg: model.headingSigmaDeg)
            CompassAdvice(model)
        }
        .compassScreen(model.compass)
        .task { await model.run() }
    }
}
