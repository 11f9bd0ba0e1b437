// Copy this file into an app with MapLibre. It is no target of its own.
import CoreLocation
import Foundation
import Magcomp
import MapLibre

/// MapLibre's locations from Core Location, and its headings from a compass:
/// `mapView.locationManager = CompassLocationManager(compass)`. Used on the main thread, as MapLibre's own.
public final class CompassLocationManager: NSObject, MLNLocationManager, CLLocationManagerDelegate, @unchecked Sendable {
    public weak var delegate: (any MLNLocationManagerDelegate)?

    private let compass: Compass
    private let locations: CLLocationManager
    /// Least change of the heading that is told, degrees, as `CLLocationManager.headingFilter`.
    private let headingFilterDeg: Double
    private var toldDeg: Double?
    /// Whether the map was told that the heading is not known.
    private var isLost = false
    private var following: Task<Void, Never>?

    public init(_ compass: Compass, locations: CLLocationManager = CLLocationManager(), headingFilterDeg: Double = 1) {
        (self.compass, self.locations, self.headingFilterDeg) = (compass, locations, headingFilterDeg)
        super.init()
        locations.delegate = self
    }

    deinit { following?.cancel() }

    /// How the device is held, as the map says: the compass's screen turns with it.
    public var headingOrientation: CLDeviceOrientation = .portrait {
        didSet {
            switch headingOrientation {
            case .portrait: compass.screenRotation = .deg0
            case .portraitUpsideDown: compass.screenRotation = .deg180
            // held with the home button's edge to the right, so the device was turned counter-clockwise
            case .landscapeLeft: compass.screenRotation = .deg90
            case .landscapeRight: compass.screenRotation = .deg270
            default: break
            }
        }
    }

    public var authorizationStatus: CLAuthorizationStatus { locations.authorizationStatus }

    public func requestAlwaysAuthorization() { locations.requestAlwaysAuthorization() }

    public func requestWhenInUseAuthorization() { locations.requestWhenInUseAuthorization() }

    public func startUpdatingLocation() { locations.startUpdatingLocation() }

    public func stopUpdatingLocation() { locations.stopUpdatingLocation() }

    public func startUpdatingHeading() {
        following?.cancel()
        (toldDeg, isLost) = (nil, false)
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

    public func stopUpdatingHeading() {
        if following != nil { lose(at: Date()) }
        following?.cancel()
        following = nil
    }

    public func dismissHeadingCalibrationDisplay() {}

    private func show(_ answer: CompensatedReading) {
        guard let headingDeg = answer.headingDeg else { return lose(at: answer.timestamp ?? Date()) }
        if let toldDeg, abs((headingDeg - toldDeg).remainder(dividingBy: 360)) < headingFilterDeg { return }
        (toldDeg, isLost) = (headingDeg, false)
        delegate?.locationManager(self, didUpdate: CompassCLHeading(answer))
    }

    /// Tells once that the heading is not known, as Core Location does: by an accuracy of -1.
    private func lose(at date: Date) {
        if isLost { return }
        (toldDeg, isLost) = (nil, true)
        delegate?.locationManager(self, didUpdate: CompassCLHeading(date))
    }

    public func locationManager(_ manager: CLLocationManager, didUpdateLocations fixes: [CLLocation]) {
        // one that is not valid leaves the declination as it is
        if let latest = fixes.last { try? compass.setPlace(latest) }
        delegate?.locationManager(self, didUpdate: fixes)
    }

    public func locationManager(_ manager: CLLocationManager, didFailWithError error: Error) {
        delegate?.locationManager(self, didFailWithError: error)
    }

    public func locationManagerDidChangeAuthorization(_ manager: CLLocationManager) {
        delegate?.locationManagerDidChangeAuthorization(self)
    }
}

/// A reading as Core Location's heading, which only a subclass can be.
private final class CompassCLHeading: CLHeading, @unchecked Sendable {
    private let answer: CompensatedReading?
    private let date: Date

    init(_ answer: CompensatedReading) {
        (self.answer, date) = (answer, answer.timestamp ?? Date())
        super.init()
    }

    /// Nothing known.
    init(_ date: Date) {
        (answer, self.date) = (nil, date)
        super.init()
    }

    required init?(coder: NSCoder) { nil }

    // negative: not known, as Core Location has it

    override var magneticHeading: Double { answer?.headingDeg ?? -1 }

    override var trueHeading: Double { answer?.trueHeadingDeg ?? -1 }

    /// The largest deviation.
    override var headingAccuracy: Double { answer.map { min(2 * ($0.headingSigmaDeg ?? 180), 180) } ?? -1 }

    override var timestamp: Date { date }
}
