// A stand-in of Ferrostar's location protocols for tests on Linux, by Ferrostar's own declarations.
import CoreLocation
import FerrostarCoreFFI

public protocol LocationProviding: AnyObject {
    var delegate: LocationManagingDelegate? { get set }
    var authorizationStatus: CLAuthorizationStatus { get }
    var lastLocation: UserLocation? { get }
    var lastHeading: Heading? { get }

    func startUpdating()
    func stopUpdating()
}

public protocol LocationManagingDelegate: AnyObject {
    func locationManager(_ manager: LocationProviding, didUpdateLocations locations: [UserLocation])
    func locationManager(_ manager: LocationProviding, didUpdateHeading newHeading: Heading)
    func locationManager(_ manager: LocationProviding, didFailWithError error: Error)
}

extension UserLocation {
    public var clLocation: CLLocation {
        CLLocation(
            coordinate: CLLocationCoordinate2D(latitude: coordinates.lat, longitude: coordinates.lng), altitude: 0,
            horizontalAccuracy: horizontalAccuracy, verticalAccuracy: -1, course: -1, courseAccuracy: -1, speed: 0,
            speedAccuracy: -1, timestamp: timestamp)
    }
}
