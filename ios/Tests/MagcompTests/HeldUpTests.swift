import Foundation
@testable import Magcomp
import Testing

/// Nobody waits for a store or a reader that takes its time.
@Suite struct HeldUpTests {
    /// A store whose `load()` waits at a gate, or asks somebody first.
    final class Asked: CalibrationStore {
        let gate = Gate()
        let kept: String?
        let asks = Shared<(@Sendable () -> Void)?>(nil)

        init(_ kept: String? = nil) { self.kept = kept }

        func load() -> String? {
            asks.value?()
            gate.pass()
            return kept
        }

        func save(_ text: String) {}

        func clear() {}
    }

    @Test func nothingWaitsForAStoreThatLoads() async throws {
        let heading = SensorSample.Heading(timeNs: 1, headingDeg: 1, sigmaDeg: 1, reference: .true, axis: .vehicle)
        let calls: [@Sendable (Compass) throws -> Void] = [
            { $0.reset() }, { _ = try $0.foundDeclination() }, { compass in _ = try compass.aid(with: heading) },
            { $0.save() },
            { try $0.setDeclinationDeg(1) },
        ]
        for call in calls {
            let (source, store) = (Live(), Asked())
            let compass = Compass(source: source, store: store)
            let seen = Shared<[CompensatedReading]>([])
            let task = reader(compass, seen)
            try await eventually { store.gate.entered.value == 1 }
            try call(compass)
            store.gate.open()
            try await source.started(1)
            #expect(store.gate.opensInTime.value == [true])
            source.play(tumbling(1))
            try await eventually { seen.value.count == 1 }
            task.cancel()
            try await task.value
        }
    }

    @Test func aStoreMayAskItsCompass() async throws {
        let (source, store) = (Live(), Asked())
        let compass = Compass(source: source, store: store)
        let asked = Shared(0)
        store.gate.open()
        store.asks.change {
            $0 = { [weak compass] in
                _ = try? compass?.foundDeclination()
                compass?.reset()
                compass?.save()
                asked.change { $0 += 1 }
            }
        }
        let task = reader(compass, Shared([]))
        try await source.started(1)
        #expect(asked.value == 1)
        task.cancel()
        try await task.value
    }

    @Test func whatIsLoadedAfterAResetIsNotTakenOver() async throws {
        let learned = try Compensator()
        _ = try learned.pushAll(tumbling(900))
        let text = try #require(try learned.keep(unixTimeS: nowS))
        for isReset in [false, true] {
            let (source, store) = (Live(), Asked(text))
            let compass = Compass(source: source, store: store, unixTimeS: { nowS })
            let seen = Shared<[CompensatedReading]>([])
            let task = reader(compass, seen)
            try await eventually { store.gate.entered.value == 1 }
            if isReset { compass.reset() }
            store.gate.open()
            try await source.started(1)
            source.play(tumbling(1))
            try await eventually { seen.value.count == 1 }
            #expect((seen.value[0].reading.fieldUt == nil) == isReset)
            task.cancel()
            try await task.value
        }
    }

    @Test func readingsOfSensorsDoNotWaitForAStoreThatSavesThoseOfARecordingDo() async throws {
        final class Closed: CalibrationStore {
            let gate = Gate()
            func load() -> String? { nil }
            func save(_ text: String) { gate.pass() }
            func clear() {}
        }
        for isLive in [true, false] {
            let store = Closed()
            let compass = Compass(source: Played(events: tumbling(900), isLive: isLive), store: store)
            let seen = Shared<[CompensatedReading]>([])
            let task = reader(compass, seen)
            try await eventually { store.gate.entered.value == 1 }
            if isLive {
                try await eventually { seen.value.count == 900 }
            } else {
                // none from the one on whose save waits
                let before = try Compensator().pushAll(tumbling(900)).prefix { $0.status != .tracking }.count
                try await eventually { seen.value.count >= before }
                for _ in 0..<200 { await Task.yield() }
                #expect(seen.value.count == before && before < 900)
            }
            for _ in 0..<3 { store.gate.open() }
            try await task.value
            #expect(seen.value.count == 900)
            #expect(store.gate.opensInTime.value.allSatisfy { $0 })
        }
    }

    @Test func aReaderThatStopsAskingHoldsNobodyUp() async throws {
        let clock = StandingClock()
        let compass = Compass(source: Played(events: tumbling(300), isLive: false), clock: clock)
        var idle = compass.readings(capacity: 4).makeAsyncIterator()
        #expect(try await idle.next()?.droppedBefore == 0)
        // alone it is waited for, however long
        for _ in 0..<6 { try await clock.turn(5) }
        #expect(try await idle.next()?.droppedBefore == 0)
        let seen = Shared<[CompensatedReading]>([])
        let other = reader(compass, seen)
        // patience is lost once: then time stands, and the other has more than what goes into the idle one's room
        let turning = Task { while seen.value.count < 10 { try await clock.turn(5) } }
        defer { turning.cancel() }
        try await eventually { seen.value.last?.sample.timeNs == 300 * stepNs }
        try await other.value
        #expect(seen.value.count > 250 && seen.value.allSatisfy { $0.droppedBefore == 0 })
        // what was kept for it is the latest
        var last: [CompensatedReading] = []
        while let answer = try await idle.next() { last.append(answer) }
        #expect(last.count == 4 && last[0].droppedBefore > 200 && last[3].sample.timeNs == 300 * stepNs)
    }

    /// Answers at these times, in steps of the sensors.
    private func answers(_ steps: [Int64]) -> [CompensatedReading] {
        steps.map { step in
            CompensatedReading(
                reading: MagneticReading(status: .tracking),
                sample: SensorSample.Magnetic(timeNs: step * stepNs, fieldUt: DeviceVector(x: 20, y: 0, z: -40)))
        }
    }

    @Test func aScreenGetsWhatItShowsAndTheLastWhateverTheClockDoes() async throws {
        // of 100 Hz every other, and another clock begins at 1
        let cases: [(steps: [Int64], seen: [Int64])] = [
            ([101, 102, 103, 104], [101, 103, 104]), ([101, 102, 103, 1, 2, 3], [101, 103, 1, 3]),
        ]
        for (steps, expected) in cases {
            let screen = Reader(run: 1, capacity: 10, rateHz: 60)
            #expect(screen.take(answers(steps)[...], waits: true).isEmpty)
            screen.finish()
            var seen: [Int64] = []
            while let answer = try await screen.next(isolation: nil) { seen.append(answer.sample.timeNs / stepNs) }
            #expect(seen == expected)
        }
    }

    @Test func patienceIsLostAtTheSecondLookWhereNothingWasTaken() async throws {
        let reader = Reader(run: 1, capacity: 4, rateHz: nil)
        #expect(reader.take(answers([1, 2, 3, 4, 5])[...], waits: true).count == 1)
        reader.losePatience()
        let waits = Task { await reader.room() }
        // it begins to wait at any time, so it is looked at until it has lost
        let looks = Task {
            while !Task.isCancelled {
                reader.losePatience()
                await Task.yield()
            }
        }
        await waits.value
        looks.cancel()
        #expect(reader.hasStopped)
        #expect(try await reader.next(isolation: nil)?.sample.timeNs == stepNs)
        #expect(!reader.hasStopped)
    }
}
