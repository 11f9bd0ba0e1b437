import Foundation
@_spi(Research) @testable import Magcomp
import MagcompTestHooks
import Testing

/// What an estimation forgets, and what it keeps: at a reset, after a defect, when a clock begins anew.
@Suite struct ResetTests {
    /// A compass that a test plays to.
    final class Played {
        let source = Live()
        let store = SavingTests.Kept()
        let compass: Compass
        let seen = Shared<[CompensatedReading]>([])
        private var task: Task<Void, any Error>?
        private var starts = 0

        init() { compass = Compass(source: source, store: store) }

        func start() async throws {
            starts += 1
            task = reader(compass, seen)
            try await source.started(starts)
        }

        /// The readings of these events.
        func play(_ events: [SensorSample]) async throws -> [CompensatedReading] {
            let before = seen.value.count
            let samples = events.filter { if case .magnetic = $0 { true } else { false } }.count
            source.play(events)
            try await eventually { seen.value.count == before + samples }
            return Array(seen.value[before...])
        }

        /// The readings end, and what is saved then is.
        func end() async throws {
            source.finish()
            try await task?.value
        }
    }

    let system = DeviceVector(x: 10, y: 28, z: -40)

    /// A phone that lies flat, and iOS's field beside it.
    func lying(_ range: Range<Int>, _ system: DeviceVector) -> [SensorSample] {
        range.flatMap { k -> [SensorSample] in
            let timeNs = Int64(k + 1) * stepNs
            return [.systemField(SensorSample.SystemField(timeNs: timeNs, fieldUt: system, accuracy: .high))] + flat(k)
        }
    }

    func later(_ events: [SensorSample], by samples: Int) -> [SensorSample] {
        events.map { SavingTests().moved($0, byNs: Int64(samples) * stepNs) }
    }

    @Test func aResetForgetsTheStoresError() async throws {
        let phone = Played()
        phone.store.state.change { $0.text = "no calibration" }
        try await phone.start()
        #expect(try await phone.play(flat(0)).last?.storeError != nil)
        phone.compass.reset()
        #expect(try await phone.play(flat(1)).last?.storeError == nil)
        try await phone.end()
    }

    @Test func aResetIsAFirstLaunchButForTheFrame() async throws {
        let phone = Played()
        try phone.compass.setDeclinationDeg(7)
        try await phone.start()
        var last = try #require(try await phone.play(tumbling(500)).last)
        await phone.compass.settled()
        #expect(phone.store.savedS.count == 1 && last.reading.heading?.trueHeadingDeg != nil)
        #expect(last.unseenDirections.count < 20)
        phone.compass.reset()
        await phone.compass.settled()
        #expect(phone.store.state.value.text == nil)
        // the same again, within 10 s of the save: what is learned is no other, and it is saved as soon
        let again = try await phone.play(later(tumbling(500), by: 500))
        await phone.compass.settled()
        #expect(again[0].unseenDirections.count > 20, "nor are directions seen")
        #expect(phone.store.savedS.count == 2 && phone.store.state.value.text != nil)
        last = try #require(again.last)
        let heading = try #require(last.reading.heading)
        #expect(
            heading.trueHeadingDeg == CompassHeading.trueHeadingDeg(headingDeg: heading.headingDeg, declinationDeg: 7))
        try await phone.end()
    }

    @Test func aResetBetweenTwoRunsForgetsWhatTheStoreKept() async throws {
        // the save at first tracking is the last of a run, too
        let auto = CompensationConfig(heading: HeadingConfig(axis: .auto))
        let readings = try Compensator(config: auto).pushAll(tumbling(900))
        let tracking = try #require(readings.firstIndex { $0.status == .tracking })
        let store = SavingTests.Kept()
        let compass = Compass(source: MagcompTests.Played(events: tumbling(tracking + 1)), store: store)
        _ = try await compass.readings(capacity: 900).collected()
        #expect(store.savedS.count == 1)
        let text = try #require(store.state.value.text)
        compass.reset()
        await compass.settled()
        #expect(store.state.value.text == nil)
        _ = try await compass.readings(capacity: 900).collected()
        // the numbers are the same to the last bit, and the store has them all the same
        #expect(store.savedS.count == 2)
        let (one, other) = (try Compensator(), try Compensator())
        try one.adoptKept(text, unixTimeS: nil)
        try other.adoptKept(try #require(store.state.value.text), unixTimeS: nil)
        #expect(try one.calibration() == other.calibration())
    }

    @Test func afterAResetTheSystemsHardIronGivesAHeadingAtOnce() async throws {
        let phone = Played()
        try await phone.start()
        #expect(try await phone.play(tumbling(900)).last?.reading.status == .tracking)
        phone.compass.reset()
        let field = try #require(try await phone.play(lying(900..<901, system)).last?.reading.fieldUt)
        #expect((field + system * -1).length < 6, "the system's, signs and all: \(field)")
        try await phone.end()
    }

    @Test func theSystemsHardIronIsToldOnce() async throws {
        let phone = Played()
        try await phone.start()
        let first = try #require(try await phone.play(lying(0..<20, system)).last?.reading)
        #expect(first.fieldUt != nil)
        // the system changes its mind by as much as a cover does
        let moved = system + DeviceVector(x: 100, y: -100, z: 50)
        let readings = try await phone.play(lying(20..<40, moved))
        #expect(readings.allSatisfy { $0.reading.reportedHardIronJumpUt == nil })
        let field = try #require(readings.last?.reading.fieldUt)
        #expect((field + system * -1).length < 6, "\(field)")
        try await phone.end()
    }

    @Test func aDefectEndsTheRunAndTheNextBeginsWithWhatTheStoreKeeps() async throws {
        let source = Live()
        let store = SavingTests.Kept()
        let compass = Compass(source: source, store: store)
        try compass.setDeclinationDeg(7)
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass, seen)
        try await source.started(1)
        source.play(tumbling(900))
        try await eventually { seen.value.count == 900 }
        await compass.settled()
        #expect(store.savedS.count == 1)
        #expect(magcomp_test_panic(try #require(compass.fastHandle)) == Int32(MAGCOMP_PANICKED))
        source.play(flat(900))
        do {
            try await task.value
            Issue.record("no error")
        } catch MagcompError.panicked(let what) {
            #expect(!what.isEmpty)
        }
        #expect(store.savedS.count == 1, "of a defect nothing is kept")
        let again = reader(compass, seen)
        try await source.started(2)
        source.play(flat(901))
        try await eventually { seen.value.count == 901 }
        #expect(seen.value.last?.reading.fieldUt != nil && seen.value.last?.trueHeadingDeg != nil, "with its frame")
        again.cancel()
        try await again.value
    }

    /// Sensors deliver late by less than a second: that is no other clock.
    @Test func aRunThatBeginsALittleEarlierHasTheSameClock() async throws {
        for (earlierMs, sameClock) in [(500, true), (1500, false)] {
            let phone = Played()
            try await phone.start()
            _ = try await phone.play(tumbling(900))
            try await phone.end()
            try await phone.start()
            let first = try #require(try await phone.play(flat(899 - earlierMs / 10)).last)
            #expect((first.reading.status.label == "rejected") == sameClock, "\(earlierMs) ms")
            try await phone.end()
        }
    }

    /// A save is due at the first look after the clock began anew, whatever the time of the save before.
    @Test func afterAnotherClockWhatChangedIsSavedAtTheFirstLook() async throws {
        let phone = Played()
        try await phone.start()
        _ = try await phone.play(tumbling(900))
        try await phone.end()
        let saves = phone.store.savedS.count
        try await phone.start()
        // less than 10 s before the save of the first run, and less than 10 s of it
        _ = try await phone.play(Array(tumbling(700).dropFirst(2 * 50)))
        await phone.compass.settled()
        #expect(phone.store.savedS.count > saves, "\(phone.store.savedS)")
        try await phone.end()
    }

    /// Another clock's gravity comes before the magnetometer, whose first sample has nearly the time of the latest look.
    @Test func afterAnotherClockDirectionsAreLookedAtWithTheFirstSample() async throws {
        let phone = Played()
        try await phone.start()
        #expect(try #require(try await phone.play(tumbling(900)).last).unseenDirections.count < 20)
        try await phone.end()
        try await phone.start()
        let first = try #require(try await phone.play(Array(flat(600)[..<1]) + flat(885)).last)
        #expect(first.reading.status.label != "rejected" && first.unseenDirections.count > 20, "\(first)")
        try await phone.end()
    }

    @Test func whatCorrectsIsSoftIronAndHardIronWithoutTheStrength() {
        let none = SoftIron(xx: 1, yy: 1, zz: 1, xy: 0, xz: 0, yz: 0)
        let calibration = MagnetometerCalibration(softIron: none, hardIronUt: hardIronUt, fieldStrengthUt: 50)
        func isSame(_ change: (inout MagnetometerCalibration) -> Void) -> Bool {
            var other = calibration
            change(&other)
            return Correction(other) == Correction(calibration)
        }
        #expect(isSame { $0.fieldStrengthUt = 51 })
        #expect(!isSame { $0.hardIronUt.z += 0.01 })
        #expect(!isSame { $0.softIron.xy = 1e-6 })
    }
}
