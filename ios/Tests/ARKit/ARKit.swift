// A stand-in of Apple's ARKit for tests on Linux: the declarations that a recipe uses, by Apple's public documentation.

import Foundation
import simd

open class ARCamera: NSObject {
    public enum TrackingState: Sendable {
        public enum Reason: Sendable { case initializing, relocalizing, excessiveMotion, insufficientFeatures }

        case notAvailable
        case limited(Reason)
        case normal
    }

    public let transform: simd_float4x4
    public let trackingState: TrackingState

    public init(transform: simd_float4x4, trackingState: TrackingState) {
        (self.transform, self.trackingState) = (transform, trackingState)
    }
}

open class ARFrame: NSObject {
    public let timestamp: TimeInterval
    public let camera: ARCamera

    public init(timestamp: TimeInterval, camera: ARCamera) { (self.timestamp, self.camera) = (timestamp, camera) }
}

open class ARSession: NSObject {}

public protocol ARSessionDelegate: NSObjectProtocol {
    func session(_ session: ARSession, didUpdate frame: ARFrame)
}
