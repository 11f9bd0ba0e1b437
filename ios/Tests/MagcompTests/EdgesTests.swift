import CoreLocation
import Foundation
import MagcompTestHooks
import Testing
import simd

@_spi(Research) @testable import Magcomp

/// Small things that no other test looks at.
@Suite struct EdgesTests {
    @Test func directionsAndQuaternionsAreThoseOfTheDevice() {
        #expect(SensorSample.HeadedAxis.heldAhead == .device(axis: DeviceVector(x: 0, y: 1, z: -1)))
        let attitude = DeviceAttitude(w: 0.1, x: 0.2, y: 0.3, z: 0.4, sigmaDeg: nil)
        #expect(simd_quatd(attitude).vector == SIMD4(0.2, 0.3, 0.4, 0.1))
    }

    @Test func anAxisThatIsSetLeavesTheRest() throws {
        let compass = Compass(source: Played(events: []))
        try compass.setDeclinationDeg(3)
        compass.screenRotation = .deg90
        compass.axis = .camera
        #expect(compass.frame == HeadingFrame(axis: .camera, screenRotation: .deg90, declinationDeg: 3))
    }

    @Test func anAnswerReachesThroughToItsReading() {
        let reading = MagneticReading(
            status: .tracking,
            heading: CompassHeading(headingDeg: 10, headingSigmaDeg: 2, trueHeadingDeg: 13, inclinationDeg: 60),
            attitude: DeviceAttitude(w: 1, x: 0, y: 0, z: 0, sigmaDeg: 4))
        let sample = SensorSample.Magnetic(timeNs: 7, fieldUt: DeviceVector(x: 1, y: 2, z: 3))
        let answer = CompensatedReading(reading: reading, sample: sample)
        #expect(answer.headingDeg == 10 && answer.headingSigmaDeg == 2 && answer.trueHeadingDeg == 13)
        #expect(answer.status == .tracking && answer.attitude == reading.attitude)
    }

    @Test func aCompensatorKeepsItsConfig() throws {
        let config = CompensationConfig(railUt: 1300, heading: HeadingConfig(axis: .camera))
        #expect(try Compensator(config: config).config == config)
    }

    @Test func aCourseIsNeverLessSureThanNothing() throws {
        let course = SensorSample.Heading(courseDeg: 90, accuracyDeg: 180, speedMS: 1, timeNs: 7, of: .heldAhead)
        #expect(try #require(course).sigmaDeg == 180)
    }

    @Test func theFieldIsThatOfTheFixesPlaceHeightAndDay() throws {
        let then = Date(timeIntervalSince1970: 1_740_000_000)
        func field(altitude: Double, accuracy: Double) throws -> EarthMagneticField {
            try EarthMagneticField(
                at: CLLocation(
                    coordinate: CLLocationCoordinate2D(latitude: 48.86, longitude: 2.35), altitude: altitude,
                    horizontalAccuracy: 5, verticalAccuracy: accuracy, course: -1, courseAccuracy: -1, speed: -1,
                    speedAccuracy: -1, timestamp: then))
        }
        func expected(heightM: Double) throws -> EarthMagneticField {
            try EarthMagneticField(latitudeDeg: 48.86, longitudeDeg: 2.35, heightM: heightM, date: then)
        }
        #expect(try field(altitude: 100_000, accuracy: 5) == expected(heightM: 100_000))
        // a height that is not valid is none
        for accuracy in [0.0, -1] { #expect(try field(altitude: 100_000, accuracy: accuracy) == expected(heightM: 0)) }
        #expect(try expected(heightM: 0) != expected(heightM: 100_000))
    }

    @Test func everyOrderAndEventIsReadFromC() {
        let orders: [ModelOrder?] = [nil, .nothing, .hardIron, .all, .former]
        let kinds: [FieldEvent.Kind?] = [nil, .deviceStep, .deviceStepBack, .placeChanged]
        for code in Int32(-1)...3 {
            var out = MagcompReading()
            out.model_order = code
            out.event = MagcompEvent(kind: min(code, 2), since_ns: 5, decided_ns: 6)
            let reading = MagneticReading(out, timeNs: 7)
            #expect(reading.modelOrder == orders[Int(code + 1)] && reading.timeNs == 7)
            let kind = kinds[Int(min(code, 2) + 1)]
            #expect(reading.event == kind.map { FieldEvent(kind: $0, sinceNs: 5, decidedNs: 6) })
        }
    }

    func magnetic(_ timeNs: Int64) -> SensorSample {
        .magnetic(SensorSample.Magnetic(timeNs: timeNs, fieldUt: DeviceVector(x: 0, y: 0, z: 0)))
    }

    @Test func aPauseIsMoreThanAQuarterOfASecond() {
        for (pauseNs, out) in [(Int64(250_000_000), [Int64]()), (250_000_001, [0])] {
            var queue = EventQueue(holdS: 1)
            #expect(queue.push([magnetic(0)]).isEmpty)
            #expect(queue.push([magnetic(pauseNs)]).map(\.timeNs) == out, "\(pauseNs)")
        }
    }

    @Test func aSecondStreamHasItsOwnBeginning() {
        var queue = EventQueue(holdS: 1)
        #expect(queue.push([magnetic(5)]).isEmpty)
        // the other sensors may still come, though they never did
        #expect(queue.push([magnetic(10_000_000_000)]).map(\.timeNs) == [5])
        #expect(queue.flush().map(\.timeNs) == [10_000_000_000])
    }

    @Test func aDifferenceTooLargeIsTheLargest() {
        #expect(Int64.max.since(.min) == .max && Int64.min.since(.max) == .min && Int64(3).since(5) == -2)
    }

    @Test func aSoftIronThatIsNotSymmetricIsRefused() throws {
        for (row, column) in [(0, 1), (0, 2), (1, 2)] {
            var m = [1.0, 0, 0, 0, 1, 0, 0, 0, 1]
            m[3 * row + column] = 1e-3
            let json = #"{"soft_iron":\#(m),"hard_iron_ut":[1.0,2.0,3.0],"field_strength_ut":45.0}"#
            #expect(throws: MagcompError.calibration(why: "no calibration of magcomp replay: soft_iron is not symmetric")) {
                try MagnetometerCalibration(json: Data(json.utf8))
            }
        }
    }

    @Test func aRunThatFailsIsSaved() async throws {
        let (source, store) = (Live(), Slow())
        let compass = Compass(source: source, store: store)
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass, seen)
        try await source.started(1)
        source.play(tumbling(900))
        try await eventually { seen.value.count == 900 }
        await compass.settled()
        let saved = store.kept.value
        source.finish(CompassError.accessRefused(sensor: .motion))
        await #expect(throws: CompassError.accessRefused(sensor: .motion)) { try await task.value }
        #expect(saved != nil && store.kept.value != saved, "what came after the save at first tracking")
    }

    /// Each takes one in turn, so each is waited for.
    @Test func twoReadersOfARecordingAreBothWaitedFor() async throws {
        let compass = Compass(source: Played(events: tumbling(200), isLive: false))
        var one = compass.readings(capacity: 2).makeAsyncIterator()
        var other = compass.readings(capacity: 2).makeAsyncIterator()
        one.start()
        other.start()
        var count = 0
        while let first = try await one.next() {
            let second = try await other.next()
            #expect(first.droppedBefore == 0 && (second?.droppedBefore ?? 0) == 0)
            count += 1
        }
        #expect(count > 190)
    }
}
