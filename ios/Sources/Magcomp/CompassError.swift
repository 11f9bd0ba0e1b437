import Foundation

/// Why a compass has no readings. Its `localizedDescription` and `recoverySuggestion` are for people, in the app's language;
/// ``developerText`` says what the app can do.
public enum CompassError: Error, Equatable, Sendable {
    /// A sensor, or what iOS makes of several; in English.
    public enum Sensor: String, CaseIterable, Sendable {
        case magnetometer
        case gyroscope
        case calibratedField = "calibrated magnetic field"
        case motion = "motion sensors"
        /// For courses (``CompassError/refusal(of:)``): it is not asked for the compass itself.
        case location = "phone's location"
        /// Without it a fix has no course.
        case preciseLocation = "phone's precise location"

        /// Which of the system's permissions it takes.
        var permission: Sensor {
            switch self {
            case .magnetometer, .gyroscope, .calibratedField, .motion: .motion
            case .location, .preciseLocation: self
            }
        }
    }

    /// The device has no such sensor; what the app can do instead.
    case missing(sensor: Sensor, advice: String)
    /// The person or a profile has refused access to the sensor.
    case accessRefused(sensor: Sensor)
    /// The system stopped delivering a sensor's events, for the reason it gave.
    case refused(sensor: Sensor, reason: String)
    /// The library: a setting out of range, or a defect.
    case library(MagcompError)
    /// The app's own source: its error's description.
    case source(String)

    init(_ error: any Error) {
        self =
            switch error {
            case let error as CompassError: error
            case let error as MagcompError: .library(error)
            default: .source(error.localizedDescription)
            }
    }

    /// Whether the person can mend it in the system's settings: `CompassAdvice` shows a button to them then, or an app its own, to
    /// `UIApplication.openSettingsURLString`.
    public var isMendedInSettings: Bool { if case .accessRefused = self { true } else { false } }

    /// Whether it may pass by itself, so that trying again is worth it: ``CompassModel/retry()``.
    public var mayPass: Bool { if case .refused = self { true } else { false } }

    /// What an app can do, in English, for a log.
    public var developerText: String {
        switch self {
        case .missing(let sensor, let advice): "this device has no \(sensor.rawValue); \(advice)"
        case .accessRefused(let sensor):
            "access to the \(sensor.rawValue) was refused; ask to allow it in Settings > Privacy & Security > "
                + (sensor.permission == .motion ? "Motion & Fitness" : "Location Services")
        case .refused(let sensor, let reason):
            "the system refused to deliver the \(sensor.rawValue) (\(reason)); iterate again to try again"
        case .library(let error): error.localizedDescription
        case .source(let description): description
        }
    }
}

extension CompassError: LocalizedError {
    public var errorDescription: String? {
        switch self {
        case .missing(let sensor, _): say("ios_error_missing", sensor.localizedName)
        case .accessRefused(let sensor): say("ios_error_access_refused", sensor.permission.localizedName)
        case .refused(let sensor, _): say("ios_error_refused", sensor.localizedName)
        case .library: say("ios_error_library")
        case .source(let description): description
        }
    }

    public var recoverySuggestion: String? {
        switch self {
        case .missing, .library, .source: nil
        case .accessRefused(let sensor):
            switch sensor.permission {
            case .location: say("ios_recovery_location")
            case .preciseLocation: say("ios_recovery_precise_location")
            default: say("ios_recovery_settings")
            }
        case .refused: say("ios_recovery_again")
        }
    }
}

#if canImport(CoreLocation)
import CoreLocation

extension CompassError {
    /// Why the fixes of this manager have no course for `Compass.aid`: the person or a profile has refused the phone's location, or
    /// allows a coarse one alone, which has none. Nil while courses may come, and before the person was asked.
    public static func refusal(of manager: CLLocationManager) -> CompassError? {
        switch manager.authorizationStatus {
        // only who was asked can have allowed a coarse one
        case .notDetermined: nil
        case .denied, .restricted: .accessRefused(sensor: .location)
        default: manager.accuracyAuthorization == .reducedAccuracy ? .accessRefused(sensor: .preciseLocation) : nil
        }
    }
}
#endif
