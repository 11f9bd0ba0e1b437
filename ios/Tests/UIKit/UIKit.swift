// A stand-in of Apple's UIKit for Linux: the declarations that the library and its sample use, by Apple's public documentation. It
// does nothing: code is compiled against it, isolation and all.

import Foundation

@MainActor open class UIResponder: NSObject {
    nonisolated override public init() { super.init() }
}

@MainActor open class UIView: UIResponder {
    public init(frame: CGRect) {}

    public required init?(coder: NSCoder) {}

    open var window: UIWindow? { nil }

    open func didMoveToWindow() {}

    open func layoutSubviews() {}
}

@MainActor open class UIWindow: UIView {
    open var windowScene: UIWindowScene? { nil }
}

@MainActor open class UIWindowScene: UIResponder {
    @MainActor open class Geometry: NSObject {
        open var interfaceOrientation: UIInterfaceOrientation { .unknown }
    }

    open var effectiveGeometry: Geometry { Geometry() }

    @available(*, deprecated, message: "since iOS 26: effectiveGeometry.interfaceOrientation")
    open var interfaceOrientation: UIInterfaceOrientation { .unknown }
}

public enum UIInterfaceOrientation: Int, Sendable {
    case unknown, portrait, portraitUpsideDown, landscapeRight, landscapeLeft
}

@MainActor open class UIApplication: UIResponder {
    nonisolated public static let openSettingsURLString = "app-settings:"
}

// Foundation's, which Linux's has not

public final class NSKeyValueObservation: NSObject, Sendable {}

public struct NSKeyValueObservedChange<Value> {}

public protocol Observed: NSObject {}

extension UIWindowScene: Observed {}

extension Observed {
    @preconcurrency nonisolated public func observe<Value>(
        _ keyPath: KeyPath<Self, Value>,
        changeHandler: @escaping @Sendable (Self, NSKeyValueObservedChange<Value>) -> Void
    ) -> NSKeyValueObservation { NSKeyValueObservation() }
}
