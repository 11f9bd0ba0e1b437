import Foundation

// As much of React Native and Flutter as docs/FRAMEWORKS.md uses, by their headers: they say nothing of what the real ones do.

class RCTEventEmitter: NSObject {
    var sent: [[String: Any]] = []

    func supportedEvents() -> [String]! { [] }
    class func requiresMainQueueSetup() -> Bool { false }
    func startObserving() {}
    func stopObserving() {}
    func sendEvent(withName name: String!, body: Any!) { sent.append(body as! [String: Any]) }
}

class FlutterError: NSObject {}

typealias FlutterEventSink = (Any?) -> Void

protocol FlutterStreamHandler {
    func onListen(withArguments arguments: Any?, eventSink events: @escaping FlutterEventSink) -> FlutterError?
    func onCancel(withArguments arguments: Any?) -> FlutterError?
}
