// A stand-in of Apple's Combine for tests on Linux: the declarations the library uses, by Apple's public documentation, so
// that the code for iOS 15 and 16 is compiled, and tests hear what it publishes.

import Foundation

public protocol ObservableObject: AnyObject {}

extension ObservableObject {
    public var objectWillChange: ObservableObjectPublisher { ObservableObjectPublisher(of: ObjectIdentifier(self)) }
}

public struct ObservableObjectPublisher: Sendable {
    private static let heard = Heard()
    private let object: ObjectIdentifier

    init(of object: ObjectIdentifier) { self.object = object }

    public func send() {
        for listener in Self.heard.listeners.withLock({ _ in Self.heard.all[object] ?? [] }) { listener() }
    }

    /// For as long as the process lives.
    public func sink(receiveValue: @escaping @Sendable () -> Void) {
        Self.heard.listeners.withLock { _ in Self.heard.all[object, default: []].append(receiveValue) }
    }

    private final class Heard: @unchecked Sendable {
        let listeners = NSLock()
        var all: [ObjectIdentifier: [@Sendable () -> Void]] = [:]
    }
}

extension NSLock {
    fileprivate func withLock<T>(_ body: (NSLock) -> T) -> T {
        lock()
        defer { unlock() }
        return body(self)
    }
}

@propertyWrapper
public struct Published<Value> {
    private var stored: Value

    public init(wrappedValue: Value) { stored = wrappedValue }

    @available(*, unavailable)
    public var wrappedValue: Value {
        get { stored }
        set { stored = newValue }
    }

    public static subscript<Object: ObservableObject>(
        _enclosingInstance object: Object, wrapped wrapped: ReferenceWritableKeyPath<Object, Value>,
        storage storage: ReferenceWritableKeyPath<Object, Self>
    ) -> Value {
        get { object[keyPath: storage].stored }
        set {
            object.objectWillChange.send()
            object[keyPath: storage].stored = newValue
        }
    }
}
