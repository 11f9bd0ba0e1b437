import Foundation

extension EarthMagneticField {
    /// The Earth's field by the World Magnetic Model.
    ///
    /// - Parameters:
    ///   - latitudeDeg: -90 to 90 degrees, north positive
    ///   - longitudeDeg: -180 to 180 degrees, east positive
    ///   - heightM: above the ellipsoid, metres, -1000 to 850000
    ///   - date: when; the field drifts. Outside the model's years it is that of their nearest day, and less sure
    /// - Throws: `MagcompError.place` when the model does not cover the place, or the date is no number
    public init(latitudeDeg: Double, longitudeDeg: Double, heightM: Double = 0, date: Date) throws {
        let unixTimeMs = (date.timeIntervalSince1970 * 1000).rounded()
        guard let unixTimeMs = Int64(exactly: unixTimeMs) else {
            throw MagcompError.place(why: "\(unixTimeMs) ms since 1970 is no date")
        }
        self = try geomagneticField(
            latitudeDeg: latitudeDeg, longitudeDeg: longitudeDeg, heightM: heightM, unixTimeMs: unixTimeMs)
    }
}

// Linux compiles this with a stand-in of CoreLocation
#if canImport(CoreLocation)
import CoreLocation

extension EarthMagneticField {
    /// The Earth's field where and when a location was taken: its `declinationDeg` is for
    /// ``Compass/setDeclinationDeg(_:)``.
    ///
    /// - Throws: `MagcompError.place` when the location is not valid
    public init(at location: CLLocation) throws {
        guard location.horizontalAccuracy >= 0 else {
            throw MagcompError.place(why: "the location is not valid: its horizontalAccuracy is negative")
        }
        // a height that is not valid may be any
        try self.init(
            latitudeDeg: location.coordinate.latitude, longitudeDeg: location.coordinate.longitude,
            heightM: location.verticalAccuracy > 0 ? location.altitude : 0, date: location.timestamp)
    }
}

extension Compass {
    /// Where the phone is, for a true heading: sets ``declinationDeg`` by `EarthMagneticField(at:)`.
    ///
    /// - Throws: `MagcompError.place` when the location is not valid; the declination stays as it was then
    public func setPlace(_ location: CLLocation) throws {
        try setDeclinationDeg(EarthMagneticField(at: location).declinationDeg)
    }
}
#endif
