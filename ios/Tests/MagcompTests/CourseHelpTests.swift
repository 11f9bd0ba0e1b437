// the sample's, which Linux compiles with a stand-in of CoreLocation
#if canImport(CourseHelp)
import CoreLocation
@testable import CourseHelp
import Foundation
import Magcomp
import Testing

@MainActor @Suite struct CourseHelpTests {
    final class Locations: CLLocationManager {
        var status = CLAuthorizationStatus.notDetermined
        var accuracy = CLAccuracyAuthorization.reducedAccuracy
        private(set) var calls: [String] = []

        override var authorizationStatus: CLAuthorizationStatus { status }
        override var accuracyAuthorization: CLAccuracyAuthorization { accuracy }

        override func requestWhenInUseAuthorization() { calls.append("ask") }
        override func startUpdatingLocation() { calls.append("start") }
        override func stopUpdatingLocation() { calls.append("stop") }
    }

    private let locations = Locations()

    /// What the person answers comes to the delegate, as at the first launch or from Settings.
    private func answer(_ status: CLAuthorizationStatus, _ accuracy: CLAccuracyAuthorization = .fullAccuracy) async {
        (locations.status, locations.accuracy) = (status, accuracy)
        locations.delegate?.locationManagerDidChangeAuthorization(locations)
        // behind what the delegate left for the main thread
        await Task { @MainActor in }.value
    }

    @Test func whoIsAskedSeesNoRefusal() async {
        let help = CourseHelp(Compass(source: Played(events: [])), locations: locations)
        await answer(.notDetermined, .reducedAccuracy)
        #expect(locations.calls.isEmpty, "nobody has asked for courses")
        help.headed = .vehicle
        #expect(locations.calls == ["ask", "start"] && help.refusal == nil)
    }

    @Test(arguments: [CLAuthorizationStatus.denied, .restricted])
    func whoRefusesIsToldAndHowToAllowIt(status: CLAuthorizationStatus) async throws {
        let help = CourseHelp(Compass(source: Played(events: [])), locations: locations)
        help.headed = .vehicle
        await answer(status)
        let refusal = try #require(help.refusal)
        #expect(refusal.localizedDescription == "The app may not use the phone's location.")
        #expect(refusal.recoverySuggestion == "Allow it in Settings > Privacy & Security > Location Services.")
        #expect(refusal.isMendedInSettings, "there is a button")
        // what was switched off has nothing to say
        help.headed = nil
        #expect(help.refusal == nil && locations.calls.last == "stop")
        // who refused in an earlier launch is told at once
        help.headed = .heldAhead
        #expect(help.refusal == refusal && locations.calls.last == "ask")
        // allowed in Settings
        await answer(.authorizedWhenInUse)
        #expect(help.refusal == nil && locations.calls.last == "start")
        // and taken back there
        await answer(status)
        #expect(help.refusal == refusal)
    }

    @Test func aCoarseLocationHasNoCourse() async throws {
        let help = CourseHelp(Compass(source: Played(events: [])), locations: locations)
        help.headed = .vehicle
        await answer(.authorizedWhenInUse, .reducedAccuracy)
        #expect(help.refusal == .accessRefused(sensor: .preciseLocation))
        for status in [CLAuthorizationStatus.authorizedWhenInUse, .authorizedAlways] {
            await answer(status)
            #expect(help.refusal == nil)
        }
    }

    @Test func whoAsksForNoCoursesIsToldNothing() async {
        let help = CourseHelp(Compass(source: Played(events: [])), locations: locations)
        await answer(.denied)
        #expect(help.refusal == nil && locations.calls.isEmpty)
    }
}
#endif
