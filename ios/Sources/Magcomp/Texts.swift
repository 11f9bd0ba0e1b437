import Foundation

// `Localizable.strings` is made of bindings/status.toml and bindings/texts.toml, as Android's string resources are. In English a text of a status is
// the core's own, without a call into the native library.

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

extension CompassError.Sensor {
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
