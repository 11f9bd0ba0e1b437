// A stand-in of Apple's CoreMotion for tests on Linux: the declarations the library uses, by Apple's public
// documentation, and in Scripted.swift what a test plays. It says nothing of what the real framework does.

import Foundation

open class CMLogItem: NSObject {
    public let timestamp: TimeInterval

    init(timestamp: TimeInterval) { self.timestamp = timestamp }
}

public struct CMMagneticField: Sendable {
    public var x, y, z: Double

    public init(x: Double, y: Double, z: Double) { (self.x, self.y, self.z) = (x, y, z) }
}

public struct CMAcceleration: Sendable {
    public var x, y, z: Double

    public init(x: Double, y: Double, z: Double) { (self.x, self.y, self.z) = (x, y, z) }
}

public struct CMRotationRate: Sendable {
    public var x, y, z: Double

    public init(x: Double, y: Double, z: Double) { (self.x, self.y, self.z) = (x, y, z) }
}

public enum CMMagneticFieldCalibrationAccuracy: Int32, Sendable {
    case uncalibrated = -1
    case low, medium, high
}

public struct CMCalibratedMagneticField: Sendable {
    public var field: CMMagneticField
    public var accuracy: CMMagneticFieldCalibrationAccuracy

    public init(field: CMMagneticField, accuracy: CMMagneticFieldCalibrationAccuracy) {
        (self.field, self.accuracy) = (field, accuracy)
    }
}

open class CMMagnetometerData: CMLogItem {
    public let magneticField: CMMagneticField

    init(timestamp: TimeInterval, magneticField: CMMagneticField) {
        self.magneticField = magneticField
        super.init(timestamp: timestamp)
    }
}

open class CMDeviceMotion: CMLogItem {
    public let rotationRate: CMRotationRate
    public let gravity: CMAcceleration
    public let magneticField: CMCalibratedMagneticField

    init(
        timestamp: TimeInterval, rotationRate: CMRotationRate, gravity: CMAcceleration,
        magneticField: CMCalibratedMagneticField
    ) {
        (self.rotationRate, self.gravity, self.magneticField) = (rotationRate, gravity, magneticField)
        super.init(timestamp: timestamp)
    }
}

public struct CMAttitudeReferenceFrame: OptionSet, Sendable {
    public let rawValue: UInt

    public init(rawValue: UInt) { self.rawValue = rawValue }

    public static let xArbitraryZVertical = CMAttitudeReferenceFrame(rawValue: 1 << 0)
    public static let xArbitraryCorrectedZVertical = CMAttitudeReferenceFrame(rawValue: 1 << 1)
    public static let xMagneticNorthZVertical = CMAttitudeReferenceFrame(rawValue: 1 << 2)
    public static let xTrueNorthZVertical = CMAttitudeReferenceFrame(rawValue: 1 << 3)
}

public let CMErrorDomain = "CMErrorDomain"

public struct CMError: RawRepresentable, Equatable, Sendable {
    public var rawValue: UInt32

    public init(rawValue: UInt32) { self.rawValue = rawValue }
}

public let CMErrorDeviceRequiresMovement = CMError(rawValue: 101)
public let CMErrorUnknown = CMError(rawValue: 103)
public let CMErrorNotAvailable = CMError(rawValue: 109)
public let CMErrorNotEntitled = CMError(rawValue: 110)
public let CMErrorNotAuthorized = CMError(rawValue: 111)

public enum CMAuthorizationStatus: Int, Sendable {
    case notDetermined, restricted, denied, authorized
}

public typealias CMMagnetometerHandler = (CMMagnetometerData?, (any Error)?) -> Void
public typealias CMDeviceMotionHandler = (CMDeviceMotion?, (any Error)?) -> Void

open class CMMotionManager: NSObject {
    let script = Script()

    public override init() { super.init() }

    open class func authorizationStatus() -> CMAuthorizationStatus { .notDetermined }

    open class func availableAttitudeReferenceFrames() -> CMAttitudeReferenceFrame {
        [.xArbitraryZVertical, .xArbitraryCorrectedZVertical]
    }

    open var magnetometerUpdateInterval: TimeInterval {
        get { script.locked { $0.magnetometerInterval } }
        set { script.locked { $0.magnetometerInterval = newValue } }
    }
    open var isMagnetometerAvailable: Bool { script.locked { $0.magnetometerAvailable } }
    open var isMagnetometerActive: Bool { script.locked { $0.magnetometer != nil } }

    open func startMagnetometerUpdates(to queue: OperationQueue, withHandler handler: @escaping CMMagnetometerHandler) {
        script.locked {
            $0.magnetometer = (queue, handler)
            $0.starts += 1
        }
    }

    open func stopMagnetometerUpdates() { script.locked { $0.magnetometer = nil } }

    open var deviceMotionUpdateInterval: TimeInterval {
        get { script.locked { $0.deviceMotionInterval } }
        set { script.locked { $0.deviceMotionInterval = newValue } }
    }
    open var isDeviceMotionAvailable: Bool { script.locked { $0.deviceMotionAvailable } }
    open var isDeviceMotionActive: Bool { script.locked { $0.deviceMotion != nil } }

    open func startDeviceMotionUpdates(
        using frame: CMAttitudeReferenceFrame, to queue: OperationQueue, withHandler handler: @escaping CMDeviceMotionHandler
    ) {
        script.locked {
            $0.deviceMotion = (queue, handler)
            $0.frame = frame
        }
    }

    open func stopDeviceMotionUpdates() { script.locked { $0.deviceMotion = nil } }
}
