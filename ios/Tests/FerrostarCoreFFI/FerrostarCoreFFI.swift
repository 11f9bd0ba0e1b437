// A stand-in of Ferrostar's generated types for tests on Linux: what the adapter uses, by Ferrostar's own declarations.
import Foundation

public struct GeographicCoordinate: Equatable, Hashable, Sendable {
    public var lat, lng: Double

    public init(lat: Double, lng: Double) { (self.lat, self.lng) = (lat, lng) }
}

public struct UserLocation: Equatable, Hashable, Sendable {
    public var coordinates: GeographicCoordinate
    public var horizontalAccuracy: Double
    public var timestamp: Date

    public init(coordinates: GeographicCoordinate, horizontalAccuracy: Double, timestamp: Date) {
        (self.coordinates, self.horizontalAccuracy, self.timestamp) = (coordinates, horizontalAccuracy, timestamp)
    }
}

public struct Heading: Equatable, Hashable, Sendable {
    public var trueHeading, accuracy: UInt16
    public var timestamp: Date

    public init(trueHeading: UInt16, accuracy: UInt16, timestamp: Date) {
        (self.trueHeading, self.accuracy, self.timestamp) = (trueHeading, accuracy, timestamp)
    }
}
