import Foundation
@_spi(Research) @testable import Magcomp
import Testing

/// However many iterate a compass's readings, there is one estimator.
@Suite(.longest) struct SharingTests {
    let events = tumbling(1500)

    @Test func severalConsumersGetTheReadingsOfOneEstimator() async throws {
        let source = Live()
        let compass = Compass(source: source)
        let seen = (0..<3).map { _ in Shared<[CompensatedReading]>([]) }
        let readers = seen.map { reader(compass, $0) }
        try await source.started(1)
        source.play(events)
        try await eventually { seen.allSatisfy { $0.value.count == 1500 } }
        // and one that comes later sees what the others see from then on
        let late = Shared<[CompensatedReading]>([])
        let last = reader(compass, late)
        source.play(flat(1500))
        try await eventually { (seen + [late]).allSatisfy { $0.value.last?.sample.timeNs == 1501 * stepNs } }
        source.finish()
        for task in readers + [last] { try await task.value }

        let alone = try Compensator(config: CompensationConfig(heading: HeadingConfig(axis: .auto))).pushAll(
            events + flat(1500))
        for one in seen { #expect(one.value.map(\.reading) == alone) }
        #expect(late.value.map(\.reading) == [alone[1500]] && late.value[0].droppedBefore == 0)
        #expect(source.state.value.starts == 1, "sensors ran once")
    }

    @Test func whatWasLearnedStaysWhileTheCompassLives() async throws {
        let source = Live()
        let compass = Compass(source: source)
        var all: [MagneticReading] = []
        for run in 0..<3 {
            let seen = Shared<[CompensatedReading]>([])
            let task = reader(compass, seen)
            try await source.started(run + 1)
            source.play(events[(run * 1000)..<((run + 1) * 1000)])
            try await eventually { seen.value.count == 500 }
            task.cancel()
            try await task.value
            try await eventually { source.state.value.ends == run + 1 }
            all += seen.value.map(\.reading)
        }
        let config = CompensationConfig(heading: HeadingConfig(axis: .auto))
        #expect(try all == Compensator(config: config).pushAll(events), "as if it had never stopped")
    }

    @Test func whoLeavesLeavesTheOthersReading() async throws {
        let source = Live()
        let compass = Compass(source: source)
        let (one, other) = (Shared<[CompensatedReading]>([]), Shared<[CompensatedReading]>([]))
        let (leaving, staying) = (reader(compass, one), reader(compass, other))
        try await source.started(1)
        source.play(flat(0))
        try await eventually { one.value.count == 1 && other.value.count == 1 }
        leaving.cancel()
        try await leaving.value
        source.play(flat(1))
        try await eventually { other.value.count == 2 || source.state.value.ends == 1 }
        #expect(other.value.count == 2)
        staying.cancel()
        try await staying.value
    }

    @Test func aClockThatBeginsAnewKeepsTheCalibration() async throws {
        let compass = Compass(source: Played(events: events))
        _ = try await compass.readings().collected()
        let again = try await compass.readings(capacity: 1500).collected()
        #expect(again.count == 1500)
        #expect(again[0].reading.fieldUt != nil && again.allSatisfy { $0.reading.status.label != "rejected" })
    }

    @Test func aThousandReadersComeAndGoFromManyThreads() async throws {
        let source = Live()
        let compass = Compass(source: source)
        let playing = Task {
            var k = 0
            while !Task.isCancelled {
                source.play([events[k % events.count]])
                k += 1
                await Task.yield()
            }
        }
        await withTaskGroup(of: Void.self) { group in
            for number in 0..<1000 {
                group.addTask {
                    let task = Task { for try await _ in compass.readings() where number % 3 != 0 { break } }
                    if number % 3 == 0 { task.cancel() }
                    if number % 100 == 50 { compass.save() }
                    if number % 100 == 99 { compass.reset() }
                    _ = try? await task.value
                }
            }
        }
        playing.cancel()
        await playing.value
        try await eventually { source.state.value.starts == source.state.value.ends }
    }

    @Test func anErrorReachesEveryoneAndTheNextRunGoesOn() async throws {
        let source = Live()
        let compass = Compass(source: source)
        let seen = (0..<2).map { _ in Shared<[CompensatedReading]>([]) }
        let readers = seen.map { reader(compass, $0) }
        try await source.started(1)
        source.play(events)
        let refused = CompassError.accessRefused(sensor: .magnetometer)
        source.finish(refused)
        for task in readers { await #expect(throws: refused) { try await task.value } }
        #expect(seen.allSatisfy { $0.value.count == 1500 })

        let again = Shared<[CompensatedReading]>([])
        let next = reader(compass, again)
        try await source.started(2)
        source.play(flat(1500))
        source.finish()
        try await next.value
        #expect(again.value.map { $0.reading.fieldUt != nil } == [true], "and with what was learned")
    }

    @Test func aDeclinationOutOfRangeIsRefusedWhenItIsSetAndChangesNothing() async throws {
        let store = Slow()
        let compass = Compass(source: Played(events: events), store: store)
        _ = try await compass.readings().collected()
        (compass.axis, compass.screenRotation) = (.camera, .deg90)
        try compass.setDeclinationDeg(-180)
        let frame = compass.frame
        func refusal(_ body: () throws -> Void) -> String {
            do {
                try body()
                return "taken"
            } catch {
                return error.localizedDescription
            }
        }
        for deg in [200, -180.5, 180.5] {
            let wrong = HeadingFrame(axis: .topEdge, screenRotation: .deg0, declinationDeg: deg)
            let core = refusal { try Compensator().setHeadingFrame(wrong) }
            #expect(core.contains("heading.declination_deg"))
            #expect(refusal { try compass.setDeclinationDeg(deg) } == core)
        }
        for deg in [Double.nan, .infinity] { #expect(refusal { try compass.setDeclinationDeg(deg) } != "taken") }
        #expect(compass.frame == frame)
        try compass.setDeclinationDeg(nil)
        #expect(compass.frame == HeadingFrame(axis: .camera, screenRotation: .deg90))
        try compass.setDeclinationDeg(2)
        let last = try #require(try await compass.readings().collected().last)
        let heading = try #require(last.reading.heading)
        #expect(heading.trueHeadingDeg == CompassHeading.trueHeadingDeg(headingDeg: heading.headingDeg, declinationDeg: 2))
        #expect(store.calls.value.filter { $0 == "load" }.count == 1, "the estimator is the same")
    }

    /// A run is at a sample when its reader leaves and another comes: that sample is not the other's.
    @Test func aReaderGetsNothingOfTheRunBeforeItsOwn() async throws {
        let source = Gated()
        let compass = Compass(source: source)
        let first = reader(compass, Shared([]))
        try await source.live.started(1)
        source.gated.change { $0 = true }
        source.live.play(flat(0))
        try await eventually { source.sensor.entered.value == 1 }
        first.cancel()
        try await first.value
        let seen = Shared<[CompensatedReading]>([])
        let second = reader(compass, seen)
        source.gated.change { $0 = false }
        source.sensor.open()
        try await source.live.started(2)
        source.live.play(flat(1))
        try await eventually { seen.value.last?.sample.timeNs == 2 * stepNs }
        #expect(seen.value.count == 1)
        second.cancel()
        try await second.value
    }

    /// A source that does not end at once when it is told to.
    @Test func aRunWaitsUntilTheOneBeforeHasEnded() async throws {
        struct Slack: MagneticFieldSource {
            let gate = Gate()
            let starts = Shared(0)

            func samples() -> SensorSamples {
                starts.change { $0 += 1 }
                return SensorSamples { [gate] in
                    AsyncStream(unfolding: {
                        gate.pass()
                        return nil
                    })
                }
            }
        }
        let source = Slack()
        let compass = Compass(source: source)
        let first = reader(compass, Shared([]))
        try await eventually { source.gate.entered.value == 1 }
        first.cancel()
        try await first.value
        let second = reader(compass, Shared([]))
        try await Task.sleep(for: .milliseconds(50))
        #expect(source.starts.value == 1)
        source.gate.open()
        source.gate.open()
        try await second.value
        #expect(source.starts.value == 2 && source.gate.opensInTime.value == [true, true])
    }

    /// Not every sequence ends with its task: what it gives once nobody reads is of no run.
    @Test func whatASourceGivesWhenItsReadersHaveLeftIsNotTaken() async throws {
        struct Deaf: MagneticFieldSource {
            struct Events: AsyncSequence, AsyncIteratorProtocol, Sendable {
                let events: [SensorSample]
                let gate: Gate
                var at = 0

                func makeAsyncIterator() -> Events { self }

                mutating func next() async -> SensorSample? {
                    if at == 2 { gate.pass() }
                    at += 1
                    return at <= events.count ? events[at - 1] : nil
                }
            }

            let gate = Gate()
            let taken = Shared(0)
            let runs = Shared(0)

            // read with every sample
            var hiddenS: Double {
                taken.change { $0 += 1 }
                return 0
            }

            func samples() -> SensorSamples {
                runs.change { $0 += 1 }
                let events = runs.value == 1 ? tumbling(100) : []
                return SensorSamples { [gate] in Events(events: events, gate: gate) }
            }
        }
        let source = Deaf()
        let compass = Compass(source: source)
        let before = source.taken.value
        let seen = Shared<[CompensatedReading]>([])
        let first = reader(compass, seen)
        try await eventually { source.gate.entered.value == 1 && seen.value.count == 1 }
        first.cancel()
        try await first.value
        source.gate.open()
        // its run begins when the first has ended
        try await reader(compass, seen).value
        #expect(source.runs.value == 2 && source.gate.opensInTime.value == [true])
        #expect(source.taken.value == before + 1)
    }

    @Test func iteratorsThatAreDroppedAtOnceStartNothing() async throws {
        let source = Live()
        let compass = Compass(source: source)
        for _ in 0..<1000 { _ = compass.readings().makeAsyncIterator() }
        for _ in 0..<1000 {
            let task = Task {
                while !Task.isCancelled { await Task.yield() }
                for try await _ in compass.readings() {}
            }
            task.cancel()
            try await task.value
        }
        // nor do those that wait to be asked
        let kept = (0..<10).map { _ in compass.readings().makeAsyncIterator() }
        try await Task.sleep(for: .milliseconds(20))
        #expect(source.state.value.starts == 0 && kept.count == 10)
        // a run waits for those before it
        let task = reader(compass, Shared([]))
        try await source.started(1)
        task.cancel()
        try await task.value
    }

    @Test func aReaderThatLeavesBeforeItsRunBeginsStartsNothing() async throws {
        let (source, store) = (Live(), Gate())
        let compass = Compass(source: source, store: store)
        let seen = Shared<[CompensatedReading]>([])
        let first = reader(compass, seen)
        try await source.started(1)
        store.open()
        source.play(events.prefix(1800))
        try await eventually { seen.value.count == 900 }
        // the save at the end of the run waits, and the next runs with it
        first.cancel()
        try await eventually { store.entered.value == 2 }
        var gone: Compass.Readings.AsyncIterator? = compass.readings().makeAsyncIterator()
        gone?.start()
        gone = nil
        let last = reader(compass, Shared([]))
        for _ in 0..<100 { await Task.yield() }
        try await Task.sleep(for: .milliseconds(20))
        #expect(source.state.value.starts == 1, "a run waits until the one before has saved")
        store.open()
        try await source.started(2)
        source.play(flat(900))
        last.cancel()
        try await last.value
        #expect(source.state.value.starts == 2, "the first and the last")
        store.open()
    }

    @Test func aRecordingWaitsForEveryReader() async throws {
        let text = "t_s,mx,my,mz\n" + (1...500).map { "\(Double($0) / 100),\($0 % 7),2,3\n" }.joined()
        let source = RecordingSource(name: "r.csv") { Data(text.utf8) }
        for compass in [Compass(source: source)] {
            var slow: [CompensatedReading] = []
            for try await reading in compass.readings(capacity: 2) {
                if slow.count < 3 { try await Task.sleep(for: .milliseconds(50)) }
                slow.append(reading)
            }
            #expect(slow.count == 500 && slow.allSatisfy { $0.droppedBefore == 0 })
        }
        var compensated: [CompensatedReading] = []
        for try await reading in source.samples().compensated(capacity: 1) {
            if compensated.count < 3 { try await Task.sleep(for: .milliseconds(50)) }
            compensated.append(reading)
        }
        #expect(compensated.count == 500 && compensated.allSatisfy { $0.droppedBefore == 0 })
    }

    @Test func aRecordingEndsWithItsReader() async throws {
        let text = "t_s,mx,my,mz\n" + (1...500).map { "\(Double($0) / 100),\($0 % 7),2,3\n" }.joined()
        let asked = Shared(0)
        let source = RecordingSource(name: "r.csv") {
            asked.change { $0 += 1 }
            return Data(text.utf8)
        }
        let compass = Compass(source: source)
        // the feeding waits for room when it is left; the next run waits for it
        let left = Shared(0)
        let leaving = Task {
            for _ in 1...3 {
                for try await _ in compass.readings(capacity: 1) {
                    try await Task.sleep(for: .milliseconds(20))
                    break
                }
                left.change { $0 += 1 }
            }
        }
        try await eventually { left.value == 3 }
        try await leaving.value
        let count = Shared(0)
        let task = Task {
            for try await _ in compass.readings(capacity: 1) { count.change { $0 += 1 } }
        }
        try await eventually { count.value == 500 }
        try await task.value
        #expect(asked.value == 4)
    }
}
