// Linux compiles this with a stand-in of SwiftUI
#if canImport(SwiftUI)
import SwiftUI

extension View {
    /// Tells a compass how far the screen of this view's window has turned, at the beginning and whenever that changes, so that headings
    /// are those of the top of what the person sees: `.compassScreen(model.compass)`. Axis and declination stay. On a Mac, whose screen
    /// does not turn, it does nothing.
    public func compassScreen(_ compass: Compass) -> some View {
        #if os(iOS)
        background(
            WindowOrientation { if let rotation = HeadingFrame.ScreenRotation($0) { compass.screenRotation = rotation } })
        #else
        self
        #endif
    }
}

#if os(iOS)
/// Says how the window is turned, at the beginning and whenever that changes.
private struct WindowOrientation: UIViewRepresentable {
    let changed: (UIInterfaceOrientation) -> Void

    func makeUIView(context: Context) -> Watching { Watching(changed) }

    func updateUIView(_ view: Watching, context: Context) {}

    final class Watching: UIView {
        private let changed: (UIInterfaceOrientation) -> Void
        private var observed: NSKeyValueObservation?

        init(_ changed: @escaping (UIInterfaceOrientation) -> Void) {
            self.changed = changed
            super.init(frame: .zero)
        }

        @available(*, unavailable)
        required init?(coder: NSCoder) { fatalError("made in code alone") }

        // half a turn lays no view out anew: the scene tells of it
        override func didMoveToWindow() {
            super.didMoveToWindow()
            observed = nil
            observed = window?.windowScene?.observe(\.effectiveGeometry) { [weak self] _, _ in
                Task { @MainActor in self?.tell() }
            }
        }

        // turning the window lays its views out anew
        override func layoutSubviews() {
            super.layoutSubviews()
            tell()
        }

        private func tell() {
            if let orientation = window?.windowScene?.effectiveGeometry.interfaceOrientation { changed(orientation) }
        }
    }
}
#endif
#endif
