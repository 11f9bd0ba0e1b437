import CoreLocation
import Foundation
import Magcomp
import Observation

/// The course of a car, or of who walks and holds the phone ahead, as help for the compass: a switch of the sample.
@MainActor @Observable
final class CourseHelp: NSObject, CLLocationManagerDelegate {
    /// Of what a course is the heading; nil: no courses are asked for.
    var headed: SensorSample.HeadedAxis? {
        didSet { headed == nil ? end() : begin() }
    }

    /// Why no courses come, for `CompassAdvice`: what the person did not allow; nil while no courses are asked for.
    private(set) var refusal: CompassError?

    private let compass: Compass
    private let locations: CLLocationManager

    init(_ compass: Compass, locations: CLLocationManager = CLLocationManager()) {
        (self.compass, self.locations) = (compass, locations)
        super.init()
        locations.delegate = self
    }

    private func begin() {
        // shows its question once; the answer comes to `locationManagerDidChangeAuthorization`
        locations.requestWhenInUseAuthorization()
        refusal = CompassError.refusal(of: locations)
        // one that was refused before it was allowed has to be started again
        if refusal == nil { locations.startUpdatingLocation() }
    }

    private func end() {
        locations.stopUpdatingLocation()
        refusal = nil
    }

    nonisolated func locationManagerDidChangeAuthorization(_ manager: CLLocationManager) {
        Task { @MainActor in
            if headed != nil { begin() }
        }
    }

    nonisolated func locationManager(_ manager: CLLocationManager, didUpdateLocations fixes: [CLLocation]) {
        Task { @MainActor in
            guard let headed else { return }
            // numbers of a fix that can't be are no help, and no harm
            for fix in fixes { _ = try? compass.aid(with: fix, pointing: headed) }
        }
    }
}
