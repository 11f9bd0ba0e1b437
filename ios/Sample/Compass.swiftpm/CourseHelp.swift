import CoreLocation
import Magcomp

/// The course of a car, or of who walks and holds the phone ahead, as help for the compass: a switch of the sample.
@MainActor
final class CourseHelp: NSObject, CLLocationManagerDelegate {
    /// Of what a course is the heading; nil: no courses are asked for.
    var headed: HeadedAxis? {
        didSet { headed == nil ? locations.stopUpdatingLocation() : begin() }
    }

    private let compass: Compass
    private let locations = CLLocationManager()

    init(_ compass: Compass) {
        self.compass = compass
        super.init()
        locations.delegate = self
    }

    private func begin() {
        locations.requestWhenInUseAuthorization()
        locations.startUpdatingLocation()
    }

    nonisolated func locationManager(_ manager: CLLocationManager, didUpdateLocations fixes: [CLLocation]) {
        Task { @MainActor in
            guard let headed else { return }
            // numbers of a fix that can't be are no help, and no harm
            for fix in fixes { _ = try? compass.aid(fix, of: headed) }
        }
    }
}
