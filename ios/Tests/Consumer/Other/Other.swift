// Another module of the app, with names that Apple's frameworks or an app have: one that the library had too would be ambiguous.
public typealias Method = OpaquePointer
public struct Event {}
public struct EventKind {}
public struct Fit {}
public struct LogLevel {}
public struct Missing {}
public struct Status {}
public struct FfiConverterTypeReading {}
public protocol ConstantFieldProtocol {}
public func attitude(fieldUt: Int, up: Int) {}
public func correct(calibration: Int, rawUt: Int) {}
public func heading(fieldUt: Int, up: Int, frame: Int) {}
