import Foundation

/// The phone's sensors can't be used as asked. The description says what an app can do.
public enum SensorError: Error, Equatable, Sendable {
    /// The device has no such sensor; what the app can do instead.
    case missing(sensor: String, advice: String)
    /// The person or a profile has refused access to the sensor.
    case accessRefused(sensor: String)
    /// The system stopped delivering a sensor's events, for the reason it gave.
    case refused(sensor: String, reason: String)
}

extension SensorError: LocalizedError {
    public var errorDescription: String? {
        switch self {
        case .missing(let sensor, let advice): "this device has no \(sensor); \(advice)"
        case .accessRefused(let sensor):
            "access to the \(sensor) was refused; ask to allow it in Settings > Privacy & Security > Motion & Fitness"
        case .refused(let sensor, let reason):
            "the system refused to deliver the \(sensor) (\(reason)); iterate again to try again"
        }
    }
}

/// Why a compass has no readings.
public enum CompassError: Error, Equatable, Sendable {
    /// The phone's sensors.
    case sensor(SensorError)
    /// The library: a setting out of range, or a defect.
    case library(MagcompError)
    /// The app's own source: its error's description.
    case source(String)

    init(_ error: any Error) {
        self =
            switch error {
            case let error as SensorError: .sensor(error)
            case let error as MagcompError: .library(error)
            default: .source(error.localizedDescription)
            }
    }

    /// Whether the person can mend it in the system's settings: an app shows a button that opens
    /// `UIApplication.openSettingsURLString` then.
    public var isMendedInSettings: Bool {
        if case .sensor(.accessRefused) = self { true } else { false }
    }
}

extension CompassError: LocalizedError {
    public var errorDescription: String? {
        switch self {
        case .sensor(let error): error.localizedDescription
        case .library(let error): error.localizedDescription
        case .source(let description): description
        }
    }
}
