import Magcomp
import SwiftUI

/// One screen: the rose, the heading with its uncertainty as an arc, the field, the status in words, and guidance.
struct CompassView: View {
    let model: CompassModel
    let source: CoreMotionSource

    var body: some View {
        VStack(spacing: 12) {
            Rose(headingDeg: model.headingDeg, sigmaDeg: model.headingSigmaDeg)
                .aspectRatio(1, contentMode: .fit)
            Text(heading).font(.largeTitle).monospacedDigit()
            Text(field).monospacedDigit()
            Text(model.status).multilineTextAlignment(.center)
            if let guidance = model.guidance { Text(guidance).bold() }
            ProgressView("directions seen", value: model.coverage)
            if let system = model.systemField {
                Text("iOS: \(microtesla(length(system.fieldUt))), accuracy \(String(describing: system.accuracy))")
                    .font(.footnote)
                // read with the system's field, which is renewed with every sample
                Text("device motion is \(lag) late").font(.footnote)
            }
        }
        .padding()
        .background(WindowOrientation { model.frame = HeadingFrame(interfaceOrientation: $0) })
        .task { await model.run() }
    }

    private var heading: String {
        guard let heading = model.headingDeg else { return "no heading yet" }
        return "\(degrees(heading)) \u{b1} \(degrees(model.headingSigmaDeg))"
    }

    private var lag: String {
        source.lagS.map { ($0 * 1000).formatted(.number.precision(.fractionLength(0))) + " ms" } ?? "not yet known to be"
    }

    private var field: String { model.totalFieldUt.map(microtesla) ?? "" }

    private func degrees(_ value: Double) -> String { value.formatted(.number.precision(.fractionLength(0))) + "\u{b0}" }

    private func microtesla(_ value: Double) -> String {
        value.formatted(.number.precision(.fractionLength(1))) + " \u{b5}T"
    }

    private func length(_ v: Vector3) -> Double { (v.x * v.x + v.y * v.y + v.z * v.z).squareRoot() }
}

/// North, east, south and west turned against the heading; the arc is one standard deviation to both sides.
struct Rose: View {
    let headingDeg: Double?
    let sigmaDeg: Double

    var body: some View {
        ZStack {
            Circle().stroke(.secondary, lineWidth: 2)
            if let headingDeg {
                Group {
                    Needle(halfWidthDeg: min(sigmaDeg, 180)).fill(.red.opacity(0.25))
                    ForEach(Array(["N", "E", "S", "W"].enumerated()), id: \.offset) { k, letter in
                        VStack {
                            Text(letter).font(.title2).foregroundStyle(k == 0 ? .red : .primary)
                            Spacer()
                        }
                        .rotationEffect(.degrees(90 * Double(k)))
                    }
                }
                .rotationEffect(.degrees(-headingDeg))
            }
        }
        .accessibilityElement()
        .accessibilityLabel(headingDeg.map { "heading \(Int($0.rounded())) degrees" } ?? "no heading yet")
    }
}

/// A sector towards the top.
struct Needle: Shape {
    let halfWidthDeg: Double

    func path(in rect: CGRect) -> Path {
        let middle = CGPoint(x: rect.midX, y: rect.midY)
        return Path { path in
            path.move(to: middle)
            path.addArc(
                center: middle, radius: min(rect.width, rect.height) / 2,
                startAngle: .degrees(-90 - halfWidthDeg), endAngle: .degrees(-90 + halfWidthDeg), clockwise: false)
            path.closeSubpath()
        }
    }
}

/// Says how the window is turned, at the beginning and whenever that changes.
struct WindowOrientation: UIViewRepresentable {
    let changed: (UIInterfaceOrientation) -> Void

    func makeUIView(context: Context) -> Watching { Watching(changed) }

    func updateUIView(_ view: Watching, context: Context) {}

    final class Watching: UIView {
        private let changed: (UIInterfaceOrientation) -> Void

        init(_ changed: @escaping (UIInterfaceOrientation) -> Void) {
            self.changed = changed
            super.init(frame: .zero)
        }

        @available(*, unavailable)
        required init?(coder: NSCoder) { fatalError("made in code alone") }

        // turning the window lays its views out anew
        override func layoutSubviews() {
            super.layoutSubviews()
            if let orientation = window?.windowScene?.interfaceOrientation { changed(orientation) }
        }
    }
}
