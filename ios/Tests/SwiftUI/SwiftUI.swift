// A stand-in of Apple's SwiftUI for Linux: the declarations that the library's views, the sample and the documents use, by Apple's
// public documentation. It draws nothing: code is compiled against it, isolation and all.

@_exported import Foundation
import Observation
@_exported import UIKit

@MainActor @preconcurrency public protocol View {
    associatedtype Body: View
    @ViewBuilder @MainActor @preconcurrency var body: Body { get }
}

/// Any view that the builders make.
public struct Built: View {
    nonisolated public init() {}

    public var body: Never { fatalError("nothing is drawn") }
}

extension Never: View { public var body: Never { fatalError("nothing is drawn") } }

extension Optional: View where Wrapped: View { public typealias Body = Never }

extension View where Body == Never { public var body: Never { fatalError("nothing is drawn") } }

@resultBuilder public enum ViewBuilder {
    public static func buildExpression<Content: View>(_ content: Content) -> Content { content }
    public static func buildBlock<Content: View>(_ content: Content) -> Content { content }
    public static func buildBlock<each Content: View>(_ content: repeat each Content) -> Built { Built() }
    public static func buildIf<Content: View>(_ content: Content?) -> Content? { content }
    public static func buildEither<Content: View>(first: Content) -> Built { Built() }
    public static func buildEither<Content: View>(second: Content) -> Built { Built() }
}

// Shapes and colours

public struct Angle: Sendable { public static func degrees(_ degrees: Double) -> Angle { Angle() } }

public protocol ShapeStyle: Sendable {}

public struct Color: ShapeStyle, View {
    public typealias Body = Never
    public static let red = Color(), orange = Color(), clear = Color(), primary = Color(), secondary = Color()

    public func opacity(_ opacity: Double) -> Color { self }
}

public struct HierarchicalShapeStyle: ShapeStyle {}

extension ShapeStyle where Self == HierarchicalShapeStyle {
    public static var primary: HierarchicalShapeStyle { HierarchicalShapeStyle() }
    public static var secondary: HierarchicalShapeStyle { HierarchicalShapeStyle() }
}

extension ShapeStyle where Self == Color { public static var red: Color { Color() } }

public enum CGLineCap: Sendable { case butt, round, square }

public struct StrokeStyle: Equatable, Sendable {
    public init(lineWidth: CGFloat = 1, lineCap: CGLineCap = .butt) {}
}

public struct Path: Equatable, Sendable {
    public init(_ callback: (inout Path) -> Void) {}

    public mutating func move(to end: CGPoint) {}
    public mutating func addLine(to end: CGPoint) {}
    public mutating func closeSubpath() {}
    public mutating func addArc(
        center: CGPoint, radius: CGFloat, startAngle: Angle, endAngle: Angle, clockwise: Bool
    ) {}
}

public protocol Shape: Sendable, View { nonisolated func path(in rect: CGRect) -> Path }

extension Shape {
    public var body: Built { Built() }

    nonisolated public func stroke(_ content: some ShapeStyle, lineWidth: CGFloat = 1) -> some View { Built() }
    nonisolated public func stroke(_ content: some ShapeStyle, style: StrokeStyle) -> some View { Built() }
    nonisolated public func fill(_ content: some ShapeStyle) -> some View { Built() }
}

public struct Circle: Shape {
    nonisolated public init() {}

    nonisolated public func path(in rect: CGRect) -> Path { Path { _ in } }
}

public struct RoundedRectangle: Shape {
    nonisolated public init(cornerRadius: CGFloat) {}

    nonisolated public func path(in rect: CGRect) -> Path { Path { _ in } }
}

// Views

public struct ZStack<Content: View>: View {
    public typealias Body = Never
    nonisolated public init(@ViewBuilder content: () -> Content) {}
}

public struct VStack<Content: View>: View {
    public typealias Body = Never
    nonisolated public init(spacing: CGFloat? = nil, @ViewBuilder content: () -> Content) {}
}

public struct Group<Content: View>: View {
    public typealias Body = Never
    nonisolated public init(@ViewBuilder content: () -> Content) {}
}

public struct ForEach<Data: RandomAccessCollection, ID: Hashable, Content: View>: View {
    public typealias Body = Never
    nonisolated public init(
        _ data: Data, id: KeyPath<Data.Element, ID>, @ViewBuilder content: @escaping (Data.Element) -> Content
    ) {}
}

public struct Spacer: View {
    public typealias Body = Never
    nonisolated public init() {}
}

public struct Text: View {
    public typealias Body = Never
    nonisolated public init<S: StringProtocol>(_ content: S) {}

    nonisolated public func bold() -> Text { self }
    nonisolated public func font(_ font: Font?) -> Text { self }
    nonisolated public func monospacedDigit() -> Text { self }
}

public struct Font: Sendable {
    public static let largeTitle = Font(), title2 = Font(), footnote = Font()
}

public struct Button<Label: View>: View { public typealias Body = Never }

extension Button where Label == Text {
    @preconcurrency nonisolated public init<S: StringProtocol>(_ title: S, action: @escaping @MainActor () -> Void) {}
}

public struct ProgressView<Label: View>: View { public typealias Body = Never }

extension ProgressView where Label == Text {
    nonisolated public init<S: StringProtocol, V: BinaryFloatingPoint>(_ title: S, value: V?, total: V = 1) {}
}

public struct Picker<SelectionValue: Hashable, Content: View>: View {
    public typealias Body = Never
    public init<S: StringProtocol>(
        _ title: S, selection: Binding<SelectionValue>, @ViewBuilder content: () -> Content
    ) {}
}

public enum Edge: Sendable {
    public struct Set: OptionSet, Sendable {
        public let rawValue: Int8

        public init(rawValue: Int8) { self.rawValue = rawValue }

        public static let top = Set(rawValue: 1), all = Set(rawValue: 15)
    }
}

public enum ContentMode: Sendable { case fit, fill }
public enum TextAlignment: Sendable { case leading, center, trailing }
public struct AccessibilityTraits: Sendable { public static let updatesFrequently = AccessibilityTraits() }
public struct AccessibilityChildBehavior: Sendable {
    public static let ignore = AccessibilityChildBehavior(), contain = AccessibilityChildBehavior()
}

extension View {
    nonisolated public func padding(_ edges: Edge.Set = .all, _ length: CGFloat? = nil) -> some View { Built() }
    nonisolated public func padding(_ length: CGFloat) -> some View { Built() }
    nonisolated public func font(_ font: Font?) -> some View { Built() }
    nonisolated public func foregroundStyle(_ style: some ShapeStyle) -> some View { Built() }
    nonisolated public func rotationEffect(_ angle: Angle) -> some View { Built() }
    nonisolated public func aspectRatio(_ ratio: CGFloat? = nil, contentMode: ContentMode) -> some View { Built() }
    nonisolated public func frame(maxWidth: CGFloat?) -> some View { Built() }
    nonisolated public func multilineTextAlignment(_ alignment: TextAlignment) -> some View { Built() }
    nonisolated public func background(_ style: some ShapeStyle, in shape: some Shape) -> some View { Built() }
    nonisolated public func background(_ background: some View) -> some View { Built() }
    nonisolated public func accessibilityElement(children: AccessibilityChildBehavior = .ignore) -> some View { Built() }
    nonisolated public func accessibilityLabel(_ label: some StringProtocol) -> some View { Built() }
    nonisolated public func accessibilityAddTraits(_ traits: AccessibilityTraits) -> some View { Built() }
    nonisolated public func tag(_ tag: some Hashable) -> some View { Built() }
    nonisolated public func task(
        @_inheritActorContext _ action: @escaping @isolated(any) @Sendable () async -> Void
    ) -> some View { Built() }
    nonisolated public func onChange(of value: some Equatable, _ action: @escaping () -> Void) -> some View { Built() }
}

@MainActor @preconcurrency public protocol UIViewRepresentable: View where Body == Never {
    associatedtype UIViewType: UIView
    typealias Context = UIViewRepresentableContext<Self>

    @MainActor @preconcurrency func makeUIView(context: Context) -> UIViewType
    @MainActor @preconcurrency func updateUIView(_ uiView: UIViewType, context: Context)
}

@MainActor @preconcurrency public struct UIViewRepresentableContext<Representable: UIViewRepresentable> {}

// An app, its state and its surroundings

@propertyWrapper public struct State<Value> {
    public init(wrappedValue value: Value) { wrappedValue = value }

    public var wrappedValue: Value {
        get { value }
        nonmutating set {}
    }
    public var projectedValue: Binding<Value> {
        Binding {
            fatalError("nothing is drawn")
        } set: { _ in
        }
    }

    private var value: Value { fatalError("nothing is drawn") }
}

@propertyWrapper public struct Binding<Value> {
    @preconcurrency public init(
        get: @escaping @isolated(any) @Sendable () -> Value, set: @escaping @isolated(any) @Sendable (Value) -> Void
    ) {}

    public var wrappedValue: Value {
        get { fatalError("nothing is drawn") }
        nonmutating set {}
    }
}

public enum ScenePhase: Sendable { case background, inactive, active }

@MainActor @preconcurrency public struct OpenURLAction: Sendable {
    public func callAsFunction(_ url: URL) {}
}

public struct EnvironmentValues: Sendable {
    public var scenePhase: ScenePhase { .active }
    public var openURL: OpenURLAction { fatalError("nothing is drawn") }
}

@propertyWrapper public struct Environment<Value> {
    public init(_ keyPath: KeyPath<EnvironmentValues, Value>) {}

    public var wrappedValue: Value { fatalError("nothing is drawn") }
}

@MainActor @preconcurrency public protocol Scene {
    associatedtype Body: Scene
    @MainActor @preconcurrency var body: Body { get }
}

extension Never: Scene {}

public struct WindowGroup<Content: View>: Scene {
    nonisolated public init(@ViewBuilder content: () -> Content) {}

    public var body: Never { fatalError("nothing is drawn") }
}

extension Scene {
    nonisolated public func onChange(of value: some Equatable, _ action: @escaping () -> Void) -> some Scene {
        WindowGroup { Built() }
    }
}

@MainActor @preconcurrency public protocol App {
    associatedtype Body: Scene
    @MainActor @preconcurrency var body: Body { get }
    @MainActor @preconcurrency init()
}

extension App { @MainActor @preconcurrency public static func main() {} }
