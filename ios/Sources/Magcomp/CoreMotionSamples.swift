// macOS has a CoreMotion without these sensors
#if canImport(CoreMotion) && !os(macOS)
import CoreMotion
import Foundation

// Core Motion's samples as events, for an app that has a motion manager of its own and pushes (``PushedSource``).

extension SensorSample {
    /// Standard gravity, m/s^2: what Core Motion calls 1 g.
    private static let gravity = 9.80665

    /// The event of a raw magnetometer sample; none where its time is none.
    public static func events(of data: CMMagnetometerData) -> [SensorSample] {
        nanoseconds(data.timestamp).map { timeNs in
            [.magnetic(SensorSample.Magnetic(timeNs: timeNs, fieldUt: DeviceVector(data.magneticField)))]
        } ?? []
    }

    /// The events of a device motion: gyroscope, gravity, which Core Motion reports in g and pointing down, as `up` in m/s^2, and the
    /// system's own field, which is there in the frame `.xArbitraryCorrectedZVertical` alone.
    ///
    /// - Parameters:
    ///   - motion: as `CMMotionManager` gives it
    ///   - options: which of them
    public static func events(
        of motion: CMDeviceMotion, _ options: CoreMotionSource.Options = CoreMotionSource.Options()
    ) -> [SensorSample] {
        guard let timeNs = nanoseconds(motion.timestamp) else { return [] }
        var events: [SensorSample] = []
        if options.gyroscope {
            let rate = motion.rotationRate
            let rateRadS = DeviceVector(x: rate.x, y: rate.y, z: rate.z)
            events.append(.rotationRate(SensorSample.RotationRate(timeNs: timeNs, rateRadS: rateRadS)))
        }
        if options.up {
            let (down, g) = (motion.gravity, gravity)
            let upMS2 = DeviceVector(x: -down.x * g, y: -down.y * g, z: -down.z * g)
            events.append(.up(SensorSample.Up(timeNs: timeNs, upMS2: upMS2)))
        }
        if options.systemField {
            let calibrated = motion.magneticField
            let accuracy: SensorSample.SystemField.Accuracy =
                switch calibrated.accuracy.rawValue {
                case 0: .low
                case 1: .medium
                case 2: .high
                default: .uncalibrated
                }
            let field = DeviceVector(calibrated.field)
            events.append(.systemField(SensorSample.SystemField(timeNs: timeNs, fieldUt: field, accuracy: accuracy)))
        }
        return events
    }
}

extension CoreMotionSource.Options {
    /// What ``Compass/init()`` asks of the phone: 100 Hz, and the system's field too, where there is one.
    public static var compass: Self { ofCompass(CMMotionManager.self) }

    static func ofCompass(_ manager: CMMotionManager.Type) -> Self {
        let isThere = manager.availableAttitudeReferenceFrames().contains(.xArbitraryCorrectedZVertical)
        return Self(systemField: isThere)
    }
}

extension CoreMotionSource {
    /// Whether this device has what a compass needs, to be asked before one is shown: `CLLocationManager.headingAvailable()` of old. It
    /// asks nobody for permission. False in the Simulator, whose ``Compass`` has a made-up phone.
    public static var isAvailable: Bool { isAvailable(CMMotionManager()) }

    static func isAvailable(_ manager: CMMotionManager) -> Bool {
        manager.isMagnetometerAvailable && manager.isDeviceMotionAvailable
    }
}

extension DeviceVector {
    fileprivate init(_ field: CMMagneticField) { self.init(x: field.x, y: field.y, z: field.z) }
}
#endif
