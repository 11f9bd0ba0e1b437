// Linux compiles this with a stand-in of SwiftUI
#if canImport(SwiftUI)
import SwiftUI

/// A compass rose: north, east, south and west in the app's language and a tick every 10 degrees turn against the heading under a
/// lubber line, which stands for the phone, with a cone of two standard deviations to both sides of north, in which it lies 19 times
/// of 20. Without a heading the circle alone. Letters follow Dynamic Type; VoiceOver reads the heading and how sure it is.
public struct CompassRose: View {
    private let headingDeg: Double?
    private let sigmaDeg: Double

    /// - Parameters:
    ///   - headingDeg: clockwise from the north the rose has, degrees, any number of turns; nil, or what is no number: not known
    ///   - sigmaDeg: one standard deviation of it, degrees; what is no sigma counts as 180
    public init(headingDeg: Double?, sigmaDeg: Double) {
        (self.headingDeg, self.sigmaDeg) = (CompassState.shownDeg(headingDeg), CompassState.shownSigmaDeg(sigmaDeg))
    }

    public var body: some View {
        ZStack {
            Circle().stroke(.secondary, lineWidth: 2)
            if let headingDeg {
                Group {
                    Cone(halfWidthDeg: min(2 * sigmaDeg, 180)).fill(.red.opacity(0.25))
                    Ticks().stroke(.secondary, lineWidth: 1)
                    ForEach(Array(roseLetters().enumerated()), id: \.offset) { k, letter in
                        VStack {
                            // within the ticks
                            Text(letter).padding(.top, 16).font(.title2).foregroundStyle(k == 0 ? Color.red : Color.primary)
                            Spacer()
                        }
                        .rotationEffect(.degrees(90 * Double(k)))
                    }
                }
                .rotationEffect(.degrees(-headingDeg))
                LubberLine().stroke(.primary, style: StrokeStyle(lineWidth: 4, lineCap: .round))
            }
        }
        .aspectRatio(1, contentMode: .fit)
        .accessibilityElement()
        .accessibilityLabel(CompassState.spoken(headingDeg: headingDeg, sigmaDeg: sigmaDeg))
        // else VoiceOver would speak without end
        .accessibilityAddTraits(.updatesFrequently)
    }
}

/// A sector about the top.
private struct Cone: Shape {
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

/// A tick every 10 degrees, longer every 30.
private struct Ticks: Shape {
    func path(in rect: CGRect) -> Path {
        let radius = min(rect.width, rect.height) / 2
        return Path { path in
            for k in 0..<36 {
                let (angle, length) = (Double(k) * .pi / 18, k.isMultiple(of: 3) ? 14.0 : 7)
                for (n, r) in [radius, radius - length].enumerated() {
                    let point = CGPoint(x: rect.midX + r * sin(angle), y: rect.midY - r * cos(angle))
                    if n == 0 { path.move(to: point) } else { path.addLine(to: point) }
                }
            }
        }
    }
}

/// A short line at the top that does not turn.
private struct LubberLine: Shape {
    func path(in rect: CGRect) -> Path {
        let top = rect.midY - min(rect.width, rect.height) / 2
        return Path { path in
            path.move(to: CGPoint(x: rect.midX, y: top))
            path.addLine(to: CGPoint(x: rect.midX, y: top + 18))
        }
    }
}

/// What the compass is doing and what the person can do, under a rose; a disturbed place stands out. Where access to the sensors was
/// refused there is a button to the app's page in Settings, and where an error may pass one to try again.
public struct CompassAdvice: View {
    private let status: String
    private let guidance: String?
    private let isDisturbed: Bool
    private let error: CompassError?
    private let retry: (() -> Void)?
    @Environment(\.openURL) private var openURL

    /// Of a compass.
    public init(_ model: CompassModel) {
        (status, guidance, isDisturbed, error) = (model.status, model.guidance, model.isDisturbed, model.error)
        retry = model.retry
    }

    /// Of an error alone, such as ``CompassError/refusal(of:)``.
    public init(_ error: CompassError) {
        (status, guidance, isDisturbed, self.error, retry) = (error.localizedDescription, nil, false, error, nil)
    }

    public var body: some View {
        VStack(spacing: 4) {
            Text(status)
            if let guidance { Text(guidance).bold() }
            if error?.mayPass == true, let retry {
                Button(say("ios_try_again")) { retry() }
            } else if let recovery = error?.recoverySuggestion {
                Text(recovery)
            }
            #if os(iOS)
            if error?.isMendedInSettings == true, let settings = URL(string: UIApplication.openSettingsURLString) {
                Button(say("ios_open_settings")) { openURL(settings) }
            }
            #endif
        }
        .multilineTextAlignment(.center)
        .padding(8)
        .frame(maxWidth: .infinity)
        .background(isDisturbed ? Color.orange.opacity(0.3) : Color.clear, in: RoundedRectangle(cornerRadius: 8))
        .accessibilityElement(children: .contain)
    }
}
#endif
