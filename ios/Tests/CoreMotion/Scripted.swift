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

    /// An error instead of a magnetometer event.
    public func magnetometerFails(_ error: any Error) {
        call(script.locked { $0.magnetometer }.map { to in (to.queue, { to.handler(nil, error) }) })
    }

    /// An error instead of a device-motion event.
    public func deviceMotionFails(_ error: any Error) {
        call(script.locked { $0.deviceMotion }.map { to in (to.queue, { to.handler(nil, error) }) })
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
