// the adapters that an app copies, with stand-ins of the maps
#if canImport(FerrostarAdapter)
import CoreLocation
import FerrostarAdapter
import FerrostarCore
import FerrostarCoreFFI
import Foundation
@testable import Magcomp
import MapLibre
import MapLibreAdapter
import Testing

private let place = CLLocation(
    coordinate: CLLocationCoordinate2D(latitude: 52.5, longitude: 13.4), altitude: 34, horizontalAccuracy: 5,
    verticalAccuracy: 3, course: -1, courseAccuracy: -1, speed: 0, speedAccuracy: -1,
    timestamp: Date(timeIntervalSince1970: 1_780_000_000))

private struct Broken: Error {}

private struct BrokenSource: MagneticFieldSource {
    func samples() -> SensorSamples {
        SensorSamples(isLive: true) { AsyncThrowingStream<SensorSample, any Error> { $0.finish(throwing: Broken()) } }
    }
}

@MainActor @Suite struct FerrostarAdapterTests {
    final class Provider: LocationProviding {
        var delegate: LocationManagingDelegate?
        var authorizationStatus = CLAuthorizationStatus.authorizedWhenInUse
        var lastLocation: UserLocation?
        var lastHeading: Heading?
        private(set) var isUpdating = false

        func startUpdating() { isUpdating = true }

        func stopUpdating() { isUpdating = false }
    }

    final class Map: LocationManagingDelegate {
        private(set) var locations: [UserLocation] = []
        private(set) var headings: [Heading] = []
        private(set) var errors: [Error] = []

        func locationManager(_ manager: LocationProviding, didUpdateLocations locations: [UserLocation]) {
            self.locations += locations
        }

        func locationManager(_ manager: LocationProviding, didUpdateHeading newHeading: Heading) {
            headings.append(newHeading)
        }

        func locationManager(_ manager: LocationProviding, didFailWithError error: Error) { errors.append(error) }
    }

    private let provider = Provider()
    private let map = Map()

    @Test func headingsAreTheCompasssTrueOnesInWholeDegrees() async throws {
        let compass = Compass(source: Played(events: tumbling(600), isLive: false))
        let adapter = CompassLocationProvider(locations: provider, compass: compass)
        adapter.delegate = map
        let here = UserLocation(coordinates: .init(lat: 52.5, lng: 13.4), horizontalAccuracy: 5, timestamp: place.timestamp)
        provider.lastLocation = here
        provider.delegate?.locationManager(provider, didUpdateLocations: [here])
        #expect(map.locations == [here] && adapter.lastLocation == here)
        let declinationDeg = try #require(compass.declinationDeg)
        #expect(abs(declinationDeg - 5) < 2)
        // the provider's own is not the compass's
        provider.delegate?.locationManager(
            provider, didUpdateHeading: Heading(trueHeading: 1, accuracy: 1, timestamp: place.timestamp))
        #expect(map.headings.isEmpty)

        let alone = Compass(source: Played(events: tumbling(600), isLive: false))
        try alone.setDeclinationDeg(declinationDeg)
        var expected: [UInt16] = []
        for try await answer in alone.readings() {
            guard let deg = answer.trueHeadingDeg else { continue }
            expected.append(UInt16(deg.rounded()) % 360)
        }
        adapter.startUpdating()
        #expect(provider.isUpdating)
        // at the recording's end the last heading is told once more, as one that says nothing
        try await eventually { adapter.lastHeading == nil && map.headings.last?.trueHeading == expected.last }
        for (one, next) in zip(map.headings, map.headings.dropFirst()) {
            #expect(one.trueHeading != next.trueHeading || one.accuracy != next.accuracy)
        }
        #expect(map.headings.last?.accuracy == 180 && map.headings.allSatisfy { (1...180).contains($0.accuracy) })
        #expect(map.headings.contains { $0.accuracy < 60 })
        adapter.stopUpdating()
        #expect(!provider.isUpdating && map.errors.isEmpty)
    }

    /// An arrow that stays where the compass knows nothing would be a wrong number.
    @Test(arguments: [true, false]) func aHeadingThatIsLostIsTold(isStopped: Bool) async throws {
        let source = Live()
        let clock = StandingClock()
        let compass = Compass(source: source, clock: clock)
        try compass.setDeclinationDeg(0)
        let adapter = CompassLocationProvider(locations: provider, compass: compass)
        adapter.delegate = map
        adapter.startUpdating()
        try await source.started(1)
        source.play(tumbling(600))
        try await eventually { !map.headings.isEmpty && compass.latest?.sample.timeNs == 600 * stepNs }
        if isStopped { adapter.stopUpdating() } else { try await clock.look(5) }
        try await eventually { adapter.lastHeading == nil }
        #expect(map.headings.last?.accuracy == 180)
        let count = map.headings.count
        if isStopped { adapter.startUpdating() }
        try await source.started(isStopped ? 2 : 1)
        source.play((600..<620).flatMap { flat($0) })
        try await eventually { map.headings.dropFirst(count).contains { $0.accuracy < 60 } }
        source.finish(Broken())
        try await eventually { map.errors.count == 1 }
        #expect(adapter.lastHeading == nil && map.headings.last?.accuracy == 180)
    }

    /// A reading that is on its way when the map stops.
    @Test func nothingIsToldAfterAStop() async throws {
        let source = PushedSource(holdS: 0)
        let compass = Compass(source: source)
        try compass.setDeclinationDeg(0)
        let adapter = CompassLocationProvider(locations: provider, compass: compass)
        adapter.delegate = map
        adapter.startUpdating()
        try await eventually { source.listeners == 1 }
        source.push(tumbling(600))
        try await eventually { adapter.lastHeading != nil }
        source.push(flat(600))
        adapter.stopUpdating()
        let count = map.headings.count
        for _ in 0..<50 { await Task.yield() }
        #expect(adapter.lastHeading == nil && map.headings.count == count && map.headings.last?.accuracy == 180)
    }

    @Test func withoutAPlaceThereIsNoHeadingAndErrorsArrive() async throws {
        let compass = Compass(source: BrokenSource())
        let adapter = CompassLocationProvider(locations: provider, compass: compass)
        adapter.delegate = map
        adapter.startUpdating()
        try await eventually { map.errors.first is Broken }
        provider.delegate?.locationManager(provider, didFailWithError: Broken())
        #expect(map.errors.count == 2 && map.headings.isEmpty)
    }
}

@MainActor @Suite struct MapLibreAdapterTests {
    final class Map: NSObject, MLNLocationManagerDelegate {
        private(set) var locations: [CLLocation] = []
        private(set) var headings: [CLHeading] = []
        private(set) var errors: [any Error] = []
        private(set) var changes = 0

        func locationManager(_ manager: any MLNLocationManager, didUpdate locations: [CLLocation]) {
            self.locations += locations
        }

        func locationManager(_ manager: any MLNLocationManager, didUpdate newHeading: CLHeading) {
            headings.append(newHeading)
        }

        func locationManagerShouldDisplayHeadingCalibration(_ manager: any MLNLocationManager) -> Bool { true }

        func locationManager(_ manager: any MLNLocationManager, didFailWithError error: any Error) { errors.append(error) }

        func locationManagerDidChangeAuthorization(_ manager: any MLNLocationManager) { changes += 1 }
    }

    private let locations = CLLocationManager()
    private let map = Map()

    @Test func headingsAreTheCompasssAndALittleChangeIsLeftOut() async throws {
        let compass = Compass(source: Played(events: tumbling(600), isLive: false))
        let adapter = CompassLocationManager(compass, locations: locations, headingFilterDeg: 5)
        adapter.delegate = map
        adapter.startUpdatingHeading()
        // before the first heading, none is told
        try await eventually { map.headings.contains { $0.headingAccuracy > 0 } }
        let known = map.headings.filter { $0.headingAccuracy > 0 }
        let first = try #require(known.first)
        #expect((0..<360).contains(first.magneticHeading) && first.trueHeading == -1)
        #expect(first.headingAccuracy <= 180)
        let none = map.headings.filter { $0.headingAccuracy <= 0 }
        #expect(none.allSatisfy { $0.headingAccuracy == -1 && $0.magneticHeading == -1 })
        for (one, next) in zip(known, known.dropFirst()) {
            #expect(abs((one.magneticHeading - next.magneticHeading).remainder(dividingBy: 360)) >= 5)
        }
        adapter.stopUpdatingHeading()

        locations.delegate?.locationManager(locations, didUpdateLocations: [place])
        #expect(map.locations == [place] && compass.declinationDeg != nil)
        locations.delegate?.locationManagerDidChangeAuthorization(locations)
        locations.delegate?.locationManager(locations, didFailWithError: Broken())
        #expect(map.changes == 1 && map.errors.count == 1)
    }

    @Test(arguments: [true, false]) func aHeadingThatIsLostIsToldOnceByANegativeAccuracy(isStopped: Bool) async throws {
        let source = Live()
        let clock = StandingClock()
        let compass = Compass(source: source, clock: clock)
        let adapter = CompassLocationManager(compass, locations: locations)
        adapter.delegate = map
        adapter.startUpdatingHeading()
        try await source.started(1)
        // nothing is known at first
        source.play(tumbling(1))
        try await eventually { map.headings.count == 1 }
        source.play(tumbling(600).dropFirst(2))
        try await eventually {
            map.headings.contains { $0.headingAccuracy > 0 } && compass.latest?.sample.timeNs == 600 * stepNs
        }
        if isStopped { adapter.stopUpdatingHeading() } else { try await clock.look(5) }
        try await eventually { map.headings.last?.headingAccuracy == -1 }
        let lost = try #require(map.headings.last)
        #expect(lost.magneticHeading == -1 && lost.trueHeading == -1 && abs(lost.timestamp.timeIntervalSinceNow) < 1e7)
        let count = map.headings.filter { $0.headingAccuracy == -1 }.count
        #expect(count == 2)
        if isStopped { adapter.startUpdatingHeading() }
        try await source.started(isStopped ? 2 : 1)
        let told = map.headings.count
        source.play((600..<620).flatMap { flat($0) })
        try await eventually { map.headings.dropFirst(told).contains { $0.headingAccuracy > 0 } }
        source.finish(Broken())
        try await eventually { map.errors.count == 1 }
        #expect(map.headings.last?.headingAccuracy == -1)
    }

    /// A reading, or an error, that is on its way when the map stops.
    @Test(arguments: [true, false]) func nothingIsToldAfterAStop(isError: Bool) async throws {
        let source = Live()
        let compass = Compass(source: source)
        let adapter = CompassLocationManager(compass, locations: locations)
        adapter.delegate = map
        adapter.startUpdatingHeading()
        try await source.started(1)
        source.play(tumbling(600))
        try await eventually {
            map.headings.last?.headingAccuracy ?? -1 > 0 && compass.latest?.sample.timeNs == 600 * stepNs
        }
        if isError { source.finish(Broken()) } else { source.play(flat(600)) }
        // the adapter is yet to be told: that takes the main thread
        busy { isError ? compass.latest == nil : compass.latest?.sample.timeNs == 601 * stepNs }
        adapter.stopUpdatingHeading()
        let count = map.headings.count
        for _ in 0..<50 { await Task.yield() }
        #expect(map.headings.count == count && map.headings.last?.headingAccuracy == -1 && map.errors.isEmpty)
    }

    @Test func theMapTellsHowTheDeviceIsHeld() {
        let compass = Compass(source: Played(events: []))
        let adapter = CompassLocationManager(compass, locations: locations)
        let held: [(CLDeviceOrientation, HeadingFrame.ScreenRotation)] = [
            (.landscapeLeft, .deg90), (.portraitUpsideDown, .deg180), (.landscapeRight, .deg270), (.faceUp, .deg270),
            (.portrait, .deg0),
        ]
        for (orientation, rotation) in held {
            adapter.headingOrientation = orientation
            #expect(compass.screenRotation == rotation)
        }
    }
}
#endif
