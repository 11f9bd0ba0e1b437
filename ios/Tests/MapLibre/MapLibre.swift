// A stand-in of MapLibre's location manager for tests on Linux: its protocols as Swift sees them, the optional parts left out.
import CoreLocation
import Foundation

public protocol MLNLocationManager: NSObjectProtocol {
    var delegate: (any MLNLocationManagerDelegate)? { get set }
    var authorizationStatus: CLAuthorizationStatus { get }
    var headingOrientation: CLDeviceOrientation { get set }

    func requestAlwaysAuthorization()
    func requestWhenInUseAuthorization()
    func startUpdatingLocation()
    func stopUpdatingLocation()
    func startUpdatingHeading()
    func stopUpdatingHeading()
    func dismissHeadingCalibrationDisplay()
}

public protocol MLNLocationManagerDelegate: NSObjectProtocol {
    func locationManager(_ manager: any MLNLocationManager, didUpdate locations: [CLLocation])
    func locationManager(_ manager: any MLNLocationManager, didUpdate newHeading: CLHeading)
    func locationManagerShouldDisplayHeadingCalibration(_ manager: any MLNLocationManager) -> Bool
    func locationManager(_ manager: any MLNLocationManager, didFailWithError error: any Error)
    func locationManagerDidChangeAuthorization(_ manager: any MLNLocationManager)
}
