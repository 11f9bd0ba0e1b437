// Copy this file into an app with Ferrostar. It is no target of its own.
import CoreLocation
import FerrostarCore
import FerrostarCoreFFI
import Foundation
import Magcomp

/// Ferrostar's locations from one provider, and its headings from a compass: give it to `FerrostarCore` in that provider's
/// place. Headings are true ones, so the first comes with the first location. Used on the main thread, as Ferrostar's own.
public final class CompassLocationProvider: LocationProviding, LocationManagingDelegate, @unchecked Sendable {
    public weak var delegate: LocationManagingDelegate?
    public private(set) var lastHeading: Heading?

    private let locations: LocationProviding
    private let compass: Compass
    private var following: Task<Void, Never>?

    public init(locations: LocationProviding, compass: Compass) {
        (self.locations, self.compass) = (locations, compass)
        locations.delegate = self
    }

    deinit { following?.cancel() }

    public var authorizationStatus: CLAuthorizationStatus { locations.authorizationStatus }

    public var lastLocation: UserLocation? { locations.lastLocation }

    public func startUpdating() {
        locations.startUpdating()
        following?.cancel()
        following = Task { @MainActor [weak self, compass] in
            do {
                // one may be on its way when this is cancelled
                for try await answer in compass.readings(capacity: 1) where !Task.isCancelled { self?.show(answer) }
                if !Task.isCancelled { self?.lose(at: Date()) }
            } catch {
                guard let self, !Task.isCancelled else { return }
                self.lose(at: Date())
                self.delegate?.locationManager(self, didFailWithError: error)
            }
        }
    }

    public func stopUpdating() {
        lose(at: Date())
        following?.cancel()
        following = nil
        locations.stopUpdating()
    }

    /// Ferrostar's headings are whole degrees: the same one is not told again.
    private func show(_ answer: CompensatedReading) {
        guard let headingDeg = answer.trueHeadingDeg else { return lose(at: answer.timestamp ?? Date()) }
        // as Core Location's accuracy, the largest deviation
        let accuracyDeg = min(2 * (answer.headingSigmaDeg ?? 180), 180).rounded(.up)
        let heading = Heading(
            trueHeading: UInt16(headingDeg.rounded()) % 360, accuracy: UInt16(accuracyDeg),
            timestamp: answer.timestamp ?? Date())
        guard heading.trueHeading != lastHeading?.trueHeading || heading.accuracy != lastHeading?.accuracy else { return }
        lastHeading = heading
        delegate?.locationManager(self, didUpdateHeading: heading)
    }

    /// There is no heading any more. Ferrostar has no word for that: the last one is told once more, with an accuracy that says nothing.
    private func lose(at date: Date) {
        guard let lost = lastHeading else { return }
        lastHeading = nil
        delegate?.locationManager(
            self, didUpdateHeading: Heading(trueHeading: lost.trueHeading, accuracy: 180, timestamp: date))
    }

    public func locationManager(_ manager: LocationProviding, didUpdateLocations locations: [UserLocation]) {
        // one that is not valid leaves the declination as it is
        if let latest = locations.last { try? compass.setPlace(latest.clLocation) }
        delegate?.locationManager(self, didUpdateLocations: locations)
    }

    /// The provider's own heading is not passed on.
    public func locationManager(_ manager: LocationProviding, didUpdateHeading newHeading: Heading) {}

    public func locationManager(_ manager: LocationProviding, didFailWithError error: Error) {
        delegate?.locationManager(self, didFailWithError: error)
    }
}
