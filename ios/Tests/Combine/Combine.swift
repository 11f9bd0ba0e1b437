// A stand-in of Apple's Combine for tests on Linux: the declarations the library uses, by Apple's public documentation, so
// that the code for iOS 15 and 16 is compiled. It publishes to nobody.

public protocol ObservableObject: AnyObject {}

@propertyWrapper
public struct Published<Value> {
    public var wrappedValue: Value

    public init(wrappedValue: Value) { self.wrappedValue = wrappedValue }
}
