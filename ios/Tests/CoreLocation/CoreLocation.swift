// A stand-in of Apple's CoreLocation for tests on Linux: the declarations that the library and its sample use, by Apple's public
// documentation. It delivers nothing: a test calls the delegate itself.

import Foundation

public struct CLLocationCoordinate2D: Sendable {
    public var latitude, longitude: Double

    public init(latitude: Double, longitude: Double) { (self.latitude, self.longitude) = (latitude, longitude) }
}

public final class CLLocation: NSObject, Sendable {
    public let coordinate: CLLocationCoordinate2D
    public let altitude, horizontalAccuracy, verticalAccuracy, course, courseAccuracy, speed, speedAccuracy: Double
    public let timestamp: Date

    public init(
        coordinate: CLLocationCoordinate2D, altitude: Double, horizontalAccuracy: Double, verticalAccuracy: Double,
        course: Double, courseAccuracy: Double, speed: Double, speedAccuracy: Double, timestamp: Date
    ) {
        (self.coordinate, self.altitude, self.timestamp) = (coordinate, altitude, timestamp)
        (self.horizontalAccuracy, self.verticalAccuracy) = (horizontalAccuracy, verticalAccuracy)
        (self.course, self.courseAccuracy) = (course, courseAccuracy)
        (self.speed, self.speedAccuracy) = (speed, speedAccuracy)
    }
}

public enum CLAuthorizationStatus: Int32, Sendable {
    case notDetermined, restricted, denied, authorizedAlways, authorizedWhenInUse
}

public enum CLAccuracyAuthorization: Int, Sendable {
    case fullAccuracy, reducedAccuracy
}

open class CLLocationManager: NSObject {
    open weak var delegate: (any CLLocationManagerDelegate)?
    open var authorizationStatus: CLAuthorizationStatus { .notDetermined }
    open var accuracyAuthorization: CLAccuracyAuthorization { .fullAccuracy }

    open func requestWhenInUseAuthorization() {}

    open func requestAlwaysAuthorization() {}

    open func startUpdatingLocation() {}

    open func stopUpdatingLocation() {}
}

public protocol CLLocationManagerDelegate: NSObjectProtocol {
    func locationManager(_ manager: CLLocationManager, didUpdateLocations locations: [CLLocation])

    func locationManager(_ manager: CLLocationManager, didFailWithError error: any Error)

    func locationManagerDidChangeAuthorization(_ manager: CLLocationManager)
}

// optional, as Apple's are
extension CLLocationManagerDelegate {
    public func locationManager(_ manager: CLLocationManager, didFailWithError error: any Error) {}
}

public enum CLDeviceOrientation: Int32, Sendable {
    case unknown, portrait, portraitUpsideDown, landscapeLeft, landscapeRight, faceUp, faceDown
}

open class CLHeading: NSObject {
    override public init() { super.init() }

    public required init?(coder: NSCoder) { super.init() }

    open var magneticHeading: Double { -1 }
    open var trueHeading: Double { -1 }
    open var headingAccuracy: Double { -1 }
    open var timestamp: Date { .distantPast }
}
