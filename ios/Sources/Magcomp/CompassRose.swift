// Linux has no SwiftUI: this file is parsed there, not compiled
#if canImport(SwiftUI)
import SwiftUI

/// A compass rose: north, east, south and west turned against the heading, and a sector of one standard deviation to both
/// sides. Empty without a heading. Letters follow Dynamic Type; VoiceOver reads the heading and how sure it is.
@available(iOS 15, macOS 12, *)
public struct CompassRose: View {
    private let headingDeg: Double?
    private let sigmaDeg: Double

    /// - Parameters:
    ///   - headingDeg: clockwise from the north the rose has, degrees; nil: not known
    ///   - sigmaDeg: one standard deviation of it, degrees
    public init(headingDeg: Double?, sigmaDeg: Double) {
        (self.headingDeg, self.sigmaDeg) = (headingDeg, sigmaDeg)
    }

    public var body: some View {
        ZStack {
            Circle().stroke(.secondary, lineWidth: 2)
            if let headingDeg {
                Group {
                    Sector(halfWidthDeg: min(sigmaDeg, 180)).fill(.red.opacity(0.25))
                    ForEach(Array(["N", "E", "S", "W"].enumerated()), id: \.offset) { k, letter in
                        VStack {
                            Text(letter).font(.title2).foregroundStyle(k == 0 ? Color.red : Color.primary)
                            Spacer()
                        }
                        .rotationEffect(.degrees(90 * Double(k)))
                    }
                }
                .rotationEffect(.degrees(-headingDeg))
            }
        }
        .aspectRatio(1, contentMode: .fit)
        .accessibilityElement()
        .accessibilityLabel(CompassState.spoken(headingDeg: headingDeg, sigmaDeg: sigmaDeg))
    }
}

/// A sector towards the top.
@available(iOS 15, macOS 12, *)
private struct Sector: Shape {
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

/// What the compass is doing and what the person can do, under a rose; a disturbed place stands out.
@available(iOS 15, macOS 12, *)
public struct CompassAdvice: View {
    private let status: String
    private let guidance: String?
    private let isDisturbed: Bool

    /// - Parameters:
    ///   - status: ``CompassState/status``
    ///   - guidance: ``CompassState/guidance``
    ///   - isDisturbed: ``CompassState/isDisturbed``
    public init(status: String, guidance: String?, isDisturbed: Bool) {
        (self.status, self.guidance, self.isDisturbed) = (status, guidance, isDisturbed)
    }

    public var body: some View {
        VStack(spacing: 4) {
            Text(status)
            if let guidance { Text(guidance).bold() }
        }
        .multilineTextAlignment(.center)
        .padding(8)
        .frame(maxWidth: .infinity)
        .background(isDisturbed ? Color.orange.opacity(0.3) : Color.clear, in: RoundedRectangle(cornerRadius: 8))
        .accessibilityElement(children: .combine)
    }
}
#endif
