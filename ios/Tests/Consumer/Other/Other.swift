// Another module of the app, with names that Apple's frameworks or an app have: one that the library had too would be ambiguous.
public typealias Method = OpaquePointer
public struct Attitude {}
public struct Axis {}
public struct Calibration {}
// as ArcGIS's toolkit has one
public struct Compass {}
public struct Config {}
public struct Coverage {}
public struct Event {}
public struct EventKind {}
public struct Fit {}
public struct GeomagneticField {}
public struct Heading {}
public struct LogLevel {}
public struct Missing {}
public struct Normalisation {}
public struct Reading {}
public struct Residual {}
public struct Status {}
public struct Termination {}
public struct Vector3 {}
public struct Yaw {}
public struct FfiConverterTypeMagneticReading {}
public protocol ConstantFieldProtocol {}
public func attitude(fieldUt: Int, up: Int) {}
public func correct(calibration: Int, rawUt: Int) {}
public func heading(fieldUt: Int, up: Int, frame: Int) {}
