import Magcomp
import SwiftUI

/// One screen: the rose, the heading with its uncertainty as an arc, the field, the status in words, and guidance.
struct CompassView: View {
    let model: CompassModel
    let source: CoreMotionSource?
    @State private var help: CourseHelp?

    var body: some View {
        VStack(spacing: 12) {
            CompassRose(headingDeg: model.headingDeg, sigmaDeg: model.headingSigmaDeg)
            Text(heading).font(.largeTitle).monospacedDigit()
            Text(field).monospacedDigit()
            CompassAdvice(model)
            ProgressView("directions seen", value: model.coverage)
            Picker("Help by the course", selection: headed) {
                Text("none").tag(SensorSample.HeadedAxis?.none)
                Text("in a holder in a car").tag(SensorSample.HeadedAxis?.some(.vehicle))
                Text("walking, held ahead").tag(SensorSample.HeadedAxis?.some(.heldAhead))
            }
            if let refusal = help?.refusal { CompassAdvice(refusal) }
            if let aid = model.reading?.headingAid { Text(aid.localizedText).font(.footnote) }
            if let system = model.reading?.systemField {
                Text("iOS: \(microtesla(length(system.fieldUt))), accuracy \(String(describing: system.accuracy))")
                    .font(.footnote)
                // read with the system's field, which is renewed with every sample
                Text("device motion is \(lag) late").font(.footnote)
            }
        }
        .padding()
        .compassScreen(model.compass)
        .task { await model.run() }
    }

    private var headed: Binding<SensorSample.HeadedAxis?> {
        Binding { @MainActor in
            help?.headed
        } set: { @MainActor headed in
            let helping = help ?? CourseHelp(model.compass)
            helping.headed = headed
            help = helping
        }
    }

    private var heading: String {
        guard let heading = model.headingDeg else { return "no heading yet" }
        return "\(degrees(heading)) \u{b1} \(degrees(model.headingSigmaDeg))"
    }

    private var lag: String {
        source?.lagS.map { ($0 * 1000).formatted(.number.precision(.fractionLength(0))) + " ms" } ?? "not yet known to be"
    }

    private var field: String { model.reading?.reading.totalFieldUt.map(microtesla) ?? "" }

    private func degrees(_ value: Double) -> String { value.formatted(.number.precision(.fractionLength(0))) + "\u{b0}" }

    private func microtesla(_ value: Double) -> String {
        value.formatted(.number.precision(.fractionLength(1))) + " \u{b5}T"
    }

    private func length(_ v: DeviceVector) -> Double { (v.x * v.x + v.y * v.y + v.z * v.z).squareRoot() }
}

#Preview {
    CompassView(model: CompassModel(compass: Compass(source: SimulatedSource())), source: nil)
}
