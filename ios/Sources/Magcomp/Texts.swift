import Foundation

// `Localizable.strings` is made of bindings/texts, as Android's string resources are. In English a text is the core's own, without a
// call into the native library.

extension CompensationStatus {
    /// One sentence an app may show, in the app's language where the package has it, else in English.
    public var localizedText: String {
        switch self {
        case .collecting(let missing): say("status_collecting", missing.localizedText)
        case .tracking: say("status_tracking")
        case .suspect: say("status_suspect")
        case .held(let reason): say("status_held", reason.localizedText)
        case .disturbed: say("status_disturbed")
        case .rejected(let reason): say("status_rejected", reason.localizedText)
        }
    }

    /// What the person can do for a better heading, in the app's language; nil: nothing.
    public var localizedGuidance: String? {
        switch self {
        case .collecting(.rotation), .held(.tooLittleRotation): say("guidance_turn")
        case .collecting(.directions), .collecting(.fit), .held(.fitRefused), .held(.lowUniformity): say("guidance_eight")
        case .collecting(.samples), .held(.atRest): say("guidance_pick_up")
        case .disturbed: say("guidance_walk_away")
        case .held(.noGyroscope), .held(.constant), .tracking, .suspect, .rejected: nil
        }
    }
}

extension FieldEvent {
    /// One sentence an app may show of a change that was decided, in the app's language.
    public var localizedText: String {
        let tookS = (Double(decidedNs) - Double(sinceNs)) * 1e-9
        return switch kind {
        case .deviceStep: say("event_device_step", tookS)
        case .deviceStepBack: say("event_device_step_back", tookS)
        case .placeChanged: say("event_place_changed", tookS)
        }
    }
}

extension CompassState {
    /// A heading as VoiceOver reads it.
    static func spoken(headingDeg: Double?, sigmaDeg: Double) -> String {
        guard let headingDeg = shownDeg(headingDeg) else { return say("spoken_no_heading") }
        // 359.6 is 0
        return say("spoken_heading", Int64(headingDeg.rounded()) % 360, Int64(shownSigmaDeg(sigmaDeg).rounded(.up)))
    }

    /// A heading as a screen shows it, degrees, 0 to 360, whatever it was given; nil for what is no number.
    static func shownDeg(_ headingDeg: Double?) -> Double? {
        guard let headingDeg, headingDeg.isFinite else { return nil }
        let shown = headingDeg.truncatingRemainder(dividingBy: 360)
        // -1e-20 + 360 is 360
        return shown >= 0 ? shown : shown + 360 < 360 ? shown + 360 : 0
    }

    /// A sigma as a screen shows it, degrees, 0 to 180; what is no sigma says that nothing is known.
    static func shownSigmaDeg(_ sigmaDeg: Double) -> Double { sigmaDeg >= 0 ? min(sigmaDeg, 180) : 180 }
}

extension CollectingReason {
    fileprivate var localizedText: String {
        switch self {
        case .samples(let have, let need): say("missing_samples", Int64(have), Int64(need))
        case .fit(let problem): problem.localizedText
        case .rotation: say("missing_rotation")
        case .directions: say("missing_directions")
        }
    }
}

extension HoldReason {
    fileprivate var localizedText: String {
        switch self {
        case .lowUniformity: say("held_low_uniformity")
        case .fitRefused(let problem): problem.localizedText
        case .constant: say("held_constant")
        case .atRest: say("held_at_rest")
        case .tooLittleRotation: say("held_too_little_rotation")
        case .noGyroscope: say("held_no_gyroscope")
        }
    }
}

extension RejectReason {
    fileprivate var localizedText: String {
        switch self {
        case .notFinite: say("rejected_not_finite")
        case .outOfRange(let valueUt, let limitUt): say("rejected_out_of_range", valueUt, limitUt)
        case .saturated(let axis, let valueUt, let railUt): say("rejected_saturated", axis.name, valueUt, railUt)
        case .timeNotAfter(let timeNs, let latestNs): say("rejected_time_not_after", timeNs, latestNs)
        case .timeJump(let gapS, let limitS): say("rejected_time_jump", gapS, limitS)
        case .stuck(let repeats): say("rejected_stuck", Int64(repeats))
        case .axes(let x, let y, let z): say("rejected_axes", [x, y, z].map(typed).joined(separator: ","))
        }
    }
}

/// An axis as one types it: `-x`.
private func typed(_ axis: Int32) -> String {
    (axis < 0 ? "-" : "") + ["x", "y", "z"][Int(axis.magnitude) - 1]
}

extension FitProblem {
    fileprivate var localizedText: String {
        switch self {
        case .tooFewSamples(let have): say("fit_too_few_samples", Int64(have))
        case .planar(let thicknessUt): say("fit_planar", thicknessUt)
        case .poorCoverage(let sigmaDeg, let limitDeg): say("fit_poor_coverage", sigmaDeg, limitDeg)
        case .inconsistent(let residualUt, let limitUt): say("fit_inconsistent", residualUt, limitUt)
        case .notAnEllipsoid: say("fit_not_an_ellipsoid")
        case .fieldOutOfRange(let fieldUt, let lowUt, let highUt): say("fit_field_out_of_range", fieldUt, lowUt, highUt)
        case .notFinite: say("fit_not_finite")
        }
    }
}

extension SensorError.Sensor {
    var localizedName: String {
        switch self {
        case .magnetometer: say("ios_sensor_magnetometer")
        case .gyroscope: say("ios_sensor_gyroscope")
        case .calibratedField: say("ios_sensor_calibrated_field")
        case .motion: say("ios_sensor_motion")
        case .location: say("ios_sensor_location")
        case .preciseLocation: say("ios_sensor_precise_location")
        }
    }
}

/// The letters of a rose, clockwise from north.
func roseLetters() -> [String] {
    [say("ios_rose_north"), say("ios_rose_east"), say("ios_rose_south"), say("ios_rose_west")]
}

/// A text in the app's language, its placeholders filled.
func say(_ key: String, _ values: any CVarArg...) -> String { Texts.shared.say(key, values) }

func say(_ key: String, _ why: String) -> String { say(key, NSString(string: why)) }

/// Where texts come from: the app's own table `Magcomp.strings`, which may translate or reword them under the names of this package's
/// `Localizable.strings`; then the package's; then English, so that an app that was copied without the package's bundle has words too.
struct Texts: Sendable {
    static let shared = Texts(app: .main, package: packagesBundle())

    private let tables: @Sendable (String) -> [String?]

    init(app: Bundle, package: Bundle?) {
        // a bundle gives the key back where it has no text
        @Sendable func text(_ bundle: Bundle?, _ key: String, _ table: String?) -> String? {
            guard let text = bundle?.localizedString(forKey: key, value: nil, table: table) else { return nil }
            return text == key || text.isEmpty ? nil : text
        }
        let (app, package) = (Unchecked(value: app), Unchecked(value: package))
        tables = { key in [text(app.value, key, "Magcomp"), text(package.value, key, nil)] }
    }

    func say(_ key: String, _ values: [any CVarArg]) -> String {
        let english = englishTexts[key] ?? key
        // what asks for other values than there are could end the app
        let wanted = Self.placeholders(english)
        let format = tables(key).lazy.compactMap { $0 }.first { Self.placeholders($0) == wanted } ?? english
        return values.isEmpty ? format : String(format: format, arguments: values)
    }

    /// Those of a format, such as `1$@`, in the order of their values.
    static func placeholders(_ format: String) -> [Substring] {
        format.split(separator: "%", omittingEmptySubsequences: false).dropFirst().map { part in
            let count = part.prefix { !$0.isLetter && $0 != "@" }
            let kind = part.dropFirst(count.count)
            return count + (kind.hasPrefix("lld") ? "lld" : kind.prefix(1))
        }.sorted()
    }

    /// The bundle beside the app or in the framework that has this code; not `Bundle.module`, which ends the app where it is missing.
    private static func packagesBundle() -> Bundle? {
        final class Here {}
        let here = Bundle(for: Here.self)
        let environment = ProcessInfo.processInfo.environment
        let folders =
            [Bundle.main.resourceURL, here.resourceURL, here.bundleURL.deletingLastPathComponent(), Bundle.main.bundleURL]
            // Xcode's previews
            + [environment["PACKAGE_RESOURCE_BUNDLE_PATH"], environment["PACKAGE_RESOURCE_BUNDLE_URL"]].map {
                $0.map { URL(fileURLWithPath: $0) }
            }
        #if os(Linux)
        let name = "magcomp_Magcomp.resources"
        #else
        let name = "magcomp_Magcomp.bundle"
        #endif
        return folders.lazy.compactMap { $0?.appendingPathComponent(name) }.compactMap { Bundle(url: $0) }.first
    }
}

/// A bundle's texts may be asked for from any thread.
private struct Unchecked<Value>: @unchecked Sendable { let value: Value }
