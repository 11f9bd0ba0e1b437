import Foundation
import Magcomp

// What docs/FRAMEWORKS.md shows; SnippetTests compares them. In the language mode that both frameworks' projects have.

/// Tells JavaScript or Dart each heading, or the sentence that says what is missing, until it is cancelled.
func told(_ compass: Compass, _ send: @escaping ([String: Any]) -> Void) -> Task<Void, Never> {
    Task { @MainActor in
        do {
            for try await it in compass.readings() where !Task.isCancelled {
                send(["headingDeg": it.headingDeg as Any, "sigmaDeg": it.headingSigmaDeg as Any, "text": it.localizedText])
            }
        } catch { send(["headingDeg": NSNull(), "sigmaDeg": NSNull(), "text": error.localizedDescription]) }
    }
}

// with `@objc(Magcomp)` before it, which Linux lacks
final class MagcompModule: RCTEventEmitter {
    private let compass = Compass()
    private var running: Task<Void, Never>?
    override func supportedEvents() -> [String]! { ["heading"] }
    override static func requiresMainQueueSetup() -> Bool { false }

    override func startObserving() {
        running = told(compass) { [weak self] in self?.sendEvent(withName: "heading", body: $0) }
    }

    override func stopObserving() { running?.cancel() }
}

final class HeadingHandler: NSObject, FlutterStreamHandler {
    private let compass = Compass()
    private var running: Task<Void, Never>?

    func onListen(withArguments arguments: Any?, eventSink events: @escaping FlutterEventSink) -> FlutterError? {
        running = told(compass) { events($0) }
        return nil
    }

    func onCancel(withArguments arguments: Any?) -> FlutterError? {
        running?.cancel()
        return nil
    }
}
