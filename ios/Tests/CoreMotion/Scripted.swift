import Foundation

/// What the tests set and see.
final class Script: @unchecked Sendable {
    struct State {
        var magnetometerAvailable = true
        var deviceMotionAvailable = true
        var magnetometerInterval = 0.0
        var deviceMotionInterval = 0.0
        var frame: CMAttitudeReferenceFrame = []
        var starts = 0
        var magnetometer: (queue: OperationQueue, handler: CMMagnetometerHandler)?
        var deviceMotion: (queue: OperationQueue, handler: CMDeviceMotionHandler)?
    }

    private var state = State()
    private let lock = NSLock()

    func locked<T>(_ body: (inout State) -> T) -> T { lock.withLock { body(&state) } }
}

extension CMMotionManager {
    /// Takes sensors away.
    public func lack(magnetometer: Bool = false, deviceMotion: Bool = false) {
        script.locked {
            $0.magnetometerAvailable = !magnetometer
            $0.deviceMotionAvailable = !deviceMotion
        }
    }

    /// How often magnetometer updates were started.
    public var starts: Int { script.locked { $0.starts } }

    /// The frame device motion was asked in.
    public var frame: CMAttitudeReferenceFrame { script.locked { $0.frame } }

    /// A magnetometer event, as the framework would call: on the queue, when updates are on.
    public func magnetometer(at timestamp: TimeInterval, _ x: Double, _ y: Double, _ z: Double) {
        let data = CMMagnetometerData(timestamp: timestamp, magneticField: CMMagneticField(x: x, y: y, z: z))
        call(script.locked { $0.magnetometer }.map { to in (to.queue, { to.handler(data, nil) }) })
    }

    /// A device-motion event.
    public func deviceMotion(
        at timestamp: TimeInterval, gravity: (Double, Double, Double), rate: (Double, Double, Double) = (0, 0, 0),
        field: CMCalibratedMagneticField = .init(field: .init(x: 0, y: 0, z: 0), accuracy: .uncalibrated)
    ) {
        let data = CMDeviceMotion(
            timestamp: timestamp, rotationRate: CMRotationRate(x: rate.0, y: rate.1, z: rate.2),
            gravity: CMAcceleration(x: gravity.0, y: gravity.1, z: gravity.2), magneticField: field)
        call(script.locked { $0.deviceMotion }.map { to in (to.queue, { to.handler(data, nil) }) })
    }

    /// What both sensors measured at one time.
    public struct Row {
        public var timestamp: TimeInterval
        public var field, gravity, rate: (Double, Double, Double)

        public init(
            timestamp: TimeInterval, field: (Double, Double, Double), gravity: (Double, Double, Double),
            rate: (Double, Double, Double)
        ) {
            (self.timestamp, self.field, self.gravity, self.rate) = (timestamp, field, gravity, rate)
        }
    }

    /// Rows as they are delivered when device motion comes later than the magnetometer, seconds; negative: earlier.
    public func play(_ rows: [Row], motionLateS: TimeInterval) {
        let late = rows.map { (at: $0.timestamp + motionLateS, motion: true, row: $0) }
        let plain = rows.map { (at: $0.timestamp, motion: false, row: $0) }
        // at one moment device motion is first
        for delivery in (late + plain).sorted(by: { ($0.at, $0.motion ? 0 : 1) < ($1.at, $1.motion ? 0 : 1) }) {
            let row = delivery.row
            if delivery.motion {
                deviceMotion(at: row.timestamp, gravity: row.gravity, rate: row.rate)
            } else {
                magnetometer(at: row.timestamp, row.field.0, row.field.1, row.field.2)
            }
        }
    }

    /// An error instead of a magnetometer event.
    public func magnetometerFails(_ error: any Error) {
        call(script.locked { $0.magnetometer }.map { to in (to.queue, { to.handler(nil, error) }) })
    }

    /// An error instead of a device-motion event.
    public func deviceMotionFails(_ error: any Error) {
        call(script.locked { $0.deviceMotion }.map { to in (to.queue, { to.handler(nil, error) }) })
    }

    /// What reports an error to who gets device motion now, even once the updates have ended: it was on its way.
    public func lateDeviceMotionError() -> (any Error) -> Void {
        let to = script.locked { $0.deviceMotion }
        return { [self] error in call(to.map { to in (to.queue, { to.handler(nil, error) }) }) }
    }

    /// What delivers a magnetometer event to who gets them now, even once the updates have ended: it was on its way.
    public func lateMagnetometer() -> (TimeInterval) -> Void {
        let to = script.locked { $0.magnetometer }
        return { [self] timestamp in
            let data = CMMagnetometerData(timestamp: timestamp, magneticField: CMMagneticField(x: 1, y: 2, z: 3))
            call(to.map { to in (to.queue, { to.handler(data, nil) }) })
        }
    }

    /// What delivers a device-motion event so.
    public func lateDeviceMotion() -> (TimeInterval) -> Void {
        let to = script.locked { $0.deviceMotion }
        return { [self] timestamp in
            let data = CMDeviceMotion(
                timestamp: timestamp, rotationRate: CMRotationRate(x: 0, y: 0, z: 0),
                gravity: CMAcceleration(x: 0, y: 0, z: -1),
                magneticField: .init(field: .init(x: 0, y: 0, z: 0), accuracy: .uncalibrated))
            call(to.map { to in (to.queue, { to.handler(data, nil) }) })
        }
    }

    private func call(_ what: (queue: OperationQueue, call: () -> Void)?) {
        guard let what else { return }
        nonisolated(unsafe) let call = what.call
        what.queue.addOperation { call() }
    }
}

extension CMError {
    /// As the framework reports it.
    public var error: NSError { NSError(domain: CMErrorDomain, code: Int(rawValue)) }
}
