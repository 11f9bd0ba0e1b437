import Foundation
@testable import Magcomp
import Testing

/// The system's own field beside the raw one: a first hard iron, where there is no better.
@Suite(.longest) struct SystemFieldTests {
    /// A phone that lies flat, beside what the system makes of it: its hard iron is 2 uT off in every axis.
    func lying(_ accuracy: SensorSample.SystemField.Accuracy, samples: Int = 20) -> [SensorSample] {
        (1...samples).flatMap { k -> [SensorSample] in
            let timeNs = Int64(k) * stepNs
            let noise = 0.2 * Double((k * 7) % 5 - 2)
            let raw = DeviceVector(x: hardIronUt.x + 10 + noise, y: hardIronUt.y + 28 - noise, z: hardIronUt.z - 40 + noise)
            let system = DeviceVector(
                x: raw.x - hardIronUt.x - 2, y: raw.y - hardIronUt.y + 2, z: raw.z - hardIronUt.z - 2)
            return [
                .up(SensorSample.Up(timeNs: timeNs, upMS2: DeviceVector(x: 0, y: 0, z: 9.81))),
                .systemField(SensorSample.SystemField(timeNs: timeNs, fieldUt: system, accuracy: accuracy)),
                .magnetic(SensorSample.Magnetic(timeNs: timeNs, fieldUt: raw)),
            ]
        }
    }

    @Test func theSystemsHardIronGivesAHeadingAtOnce() async throws {
        let trueDeg = atan2(-10, 28.0) * 180 / Double.pi
        for accuracy in [SensorSample.SystemField.Accuracy.high, .medium, .low] {
            let readings = try await Compass(source: Played(events: lying(accuracy))).readings().collected()
            let first = try #require(readings.first?.reading.heading, "\(accuracy)")
            let sigma = try #require(first.headingSigmaDeg)
            #expect(abs((first.headingDeg - trueDeg).remainder(dividingBy: 360)) < 3 * sigma, "\(first), true \(trueDeg)")
            #expect(abs((first.headingDeg - trueDeg).remainder(dividingBy: 360)) > 2, "it is the system's, not our own")
            #expect((15...60).contains(sigma), "13 uT in 30: \(sigma)")
            #expect(readings.allSatisfy { $0.reading.heading != nil })
        }
        let without = CompensationConfig(useReportedHardIron: false)
        let refused = try await Compass(source: Played(events: lying(.high)), config: without).readings().collected()
        #expect(refused.allSatisfy { $0.reading.heading == nil })
        // the system knows nothing, or its field is of another time
        var old = lying(.high)
        old[1] = .systemField(
            SensorSample.SystemField(timeNs: -5 * stepNs, fieldUt: DeviceVector(x: 10, y: 28, z: -40), accuracy: .high))
        for events in [lying(.uncalibrated), Array(old[..<3])] {
            let readings = try await Compass(source: Played(events: events)).readings().collected()
            #expect(readings.allSatisfy { $0.reading.heading == nil && $0.reading.status.label == "collecting" })
        }
    }

    /// The system's field comes every 50 ms and once, after a pause, later; samples come between.
    @Test func theSystemsFieldBelongsToASampleWithinItsOwnPeriod() async throws {
        func system(_ ms: Int64) -> SensorSample {
            let field = DeviceVector(x: 10, y: 28, z: -40)
            return .systemField(SensorSample.SystemField(timeNs: ms * 1_000_000, fieldUt: field, accuracy: .high))
        }
        func sample(_ ms: Int64) -> [SensorSample] {
            let raw = DeviceVector(x: hardIronUt.x + 10, y: hardIronUt.y + 28, z: hardIronUt.z - 40)
            return [
                .up(SensorSample.Up(timeNs: ms * 1_000_000, upMS2: DeviceVector(x: 0, y: 0, z: 9.81))),
                .magnetic(SensorSample.Magnetic(timeNs: ms * 1_000_000, fieldUt: raw)),
            ]
        }
        func isBeside(_ events: [SensorSample]) async throws -> Bool {
            let readings = try await Compass(source: Played(events: events)).readings().collected()
            return try #require(readings.last).reading.fieldUt != nil
        }
        #expect(try await isBeside([system(1000)] + sample(1003)), "delivered apart")
        #expect(try await isBeside([system(1000)] + sample(1020)))
        #expect(try await !isBeside([system(1000)] + sample(1021)), "its period is not known")
        #expect(try await isBeside([system(950), system(1000)] + sample(1050)))
        #expect(try await !isBeside([system(950), system(1000)] + sample(1051)))
        #expect(try await isBeside([system(950), system(1000), system(1000)] + sample(1050)), "twice the same")
        #expect(try await !isBeside([system(990), system(1000)] + sample(1011)))
        #expect(try await isBeside([system(1000)] + sample(990)), "a moment before it is as near")
        #expect(try await isBeside([system(1000), system(2000)] + sample(3000)), "1 Hz")
        #expect(try await !isBeside([system(1000), system(61_000)] + sample(61_021)), "a pause is no period")

        // nor is what came before in a run of the same compass
        let runs = CompassModelTests.Runs(samplesOfRuns: [
            Played(events: [system(950), system(1000)]).samples(), Played(events: sample(1010)).samples(),
            Played(events: [system(1100)] + sample(1150)).samples(),
        ])
        let compass = Compass(source: runs)
        _ = try await compass.readings().collected()
        for _ in 2...3 {
            let last = try #require(try await compass.readings().collected().last)
            #expect(last.reading.fieldUt == nil)
            if runs.run.value == 2 { #expect(last.systemField == nil) }
        }
    }

    /// Device motion comes later than the magnetometer: the first samples have nothing of the system's beside them.
    @Test func aFirstSampleWithoutTheSystemsFieldLeavesTheWishForIt() async throws {
        let events = lying(.high)
        let late = events.enumerated().filter { number, event in
            if case .systemField = event { number > 9 } else { true }
        }.map(\.element)
        let readings = try await Compass(source: Played(events: late)).readings().collected()
        let first = try #require(readings.firstIndex { $0.headingDeg != nil })
        #expect((2...4).contains(first) && readings[0].systemField == nil && readings.count == 20)
    }

    @Test func whatWasLearnedIsBetterThanTheSystems() async throws {
        let store = Slow()
        _ = try await Compass(source: Played(events: tumbling(1500)), store: store).readings().collected()
        let next = try await Compass(source: Played(events: lying(.high)), store: store).readings().collected()
        let first = try #require(next.first?.reading)
        #expect(abs(try #require(first.fieldUt).y - 28) < 1, "\(first)")
    }
}
