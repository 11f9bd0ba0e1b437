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
