import Foundation
@testable import Magcomp
import Testing

/// However many iterate a compass's readings, there is one estimator.
@Suite(.timeLimit(.minutes(3))) struct SharingTests {
    let events = tumbling(1500)

    /// A live source that a test plays; every start is another run.
    final class Live: MagneticFieldSource {
        struct State {
            var starts = 0
            var ends = 0
            var listener: AsyncThrowingStream<SensorSample, any Error>.Continuation?
        }

        let state = Shared(State())

        func samples() -> SensorSamples {
            SensorSamples { [state] in
                AsyncThrowingStream { listener in
                    state.change {
                        $0.starts += 1
                        $0.listener = listener
                    }
                    listener.onTermination = { _ in state.change { $0.ends += 1 } }
                }
            }
        }

        func play(_ events: some Sequence<SensorSample>) {
            for event in events { state.value.listener?.yield(event) }
        }

        func finish(_ error: (any Error)? = nil) { state.value.listener?.finish(throwing: error) }

        func started(_ times: Int) async throws { try await eventually { state.value.starts == times } }
    }

    /// Reads from now on; `seen` grows.
    func reader(_ compass: Compass, _ seen: Shared<[CompensatedReading]>) -> Task<Void, any Error> {
        var begun = compass.readings(capacity: 10_000).makeAsyncIterator()
        begun.start()
        return Task { [begun] in
            var iterator = begun
            while let reading = try await iterator.next() { seen.change { $0.append(reading) } }
        }
    }

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

        let alone = try Compensator(config: Config(heading: HeadingConfig(axis: .auto))).pushAll(events + flat(1500))
        for one in seen { #expect(one.value.map(\.reading) == alone) }
        #expect(late.value.map(\.reading) == [alone[1500]] && late.value[0].droppedBefore == 0)
        #expect(source.state.value.starts == 1, "sensors ran once")
    }

    @Test func whatWasLearnedStaysWhileTheCompassLives() async throws {
        let source = Live()
        let compass = Compass(source: source)
        var all: [Reading] = []
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
        let config = Config(heading: HeadingConfig(axis: .auto))
        #expect(try all == Compensator(config: config).pushAll(events), "as if it had never stopped")
    }

    @Test func aClockThatBeginsAnewKeepsTheCalibration() async throws {
        let compass = Compass(source: Played(events: events))
        _ = try await compass.readings().collected()
        let again = try await compass.readings(capacity: 1500).collected()
        #expect(again.count == 1500)
        #expect(again[0].reading.fieldUt != nil && again.allSatisfy { $0.reading.status.label != "rejected" })
    }

    final class Slow: CalibrationStore {
        let calls = Shared<[String]>([])
        let kept = Shared<String?>(nil)

        func load() -> String? {
            calls.change { $0.append("load") }
            return kept.value
        }

        func save(_ text: String) {
            calls.change { $0.append("save") }
            Thread.sleep(forTimeInterval: 0.05)
            kept.change { $0 = text }
            calls.change { $0.append("saved") }
        }

        func clear() {
            calls.change { $0.append("clear") }
            kept.change { $0 = nil }
        }
    }

    /// As views come and go: the next run begins when the one before has saved, and loads nothing old.
    @Test func aHundredTurnsWithASlowStoreLoseNothing() async throws {
        let (source, store) = (Live(), Slow())
        let compass = Compass(source: source, store: store)
        let all = tumbling(4000)
        var readings: [Reading] = []
        for run in 0..<100 {
            let seen = Shared<[CompensatedReading]>([])
            let task = reader(compass, seen)
            try await source.started(run + 1)
            source.play(all[(run * 80)..<((run + 1) * 80)])
            try await eventually { seen.value.count == 40 }
            task.cancel()
            try await task.value
            readings += seen.value.map(\.reading)
        }
        try await eventually { source.state.value.ends == 100 }
        #expect(try readings == Compensator(config: Config(heading: HeadingConfig(axis: .auto))).pushAll(all))
        let calls = store.calls.value
        #expect(calls.first == "load" && calls.filter { $0 == "load" }.count == 1)
        let saves = calls.dropFirst()
        #expect(saves.count > 10 && saves.count.isMultiple(of: 2))
        #expect(saves.enumerated().allSatisfy { $1 == ($0.isMultiple(of: 2) ? "save" : "saved") }, "never two at once")
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
        let refused = SensorError.accessRefused(sensor: .magnetometer)
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
        try compass.setFrame(HeadingFrame(axis: .camera, screenRotation: .deg90, declinationDeg: -180))
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
            #expect(refusal { try compass.setFrame(wrong) } == core)
        }
        for deg in [Double.nan, .infinity] { #expect(refusal { try compass.setDeclinationDeg(deg) } != "taken") }
        #expect(compass.frame == frame)
        try compass.setDeclinationDeg(nil)
        #expect(compass.frame == HeadingFrame(axis: .camera, screenRotation: .deg90))
        try compass.setDeclinationDeg(2)
        let last = try #require(try await compass.readings().collected().last)
        let heading = try #require(last.reading.heading)
        #expect(heading.trueHeadingDeg == Heading.trueHeadingDeg(headingDeg: heading.headingDeg, declinationDeg: 2))
        #expect(store.calls.value.filter { $0 == "load" }.count == 1, "the estimator is the same")
    }

    @Test func resetForgetsWhatWasLearnedInTheStoreToo() async throws {
        let (source, store) = (Live(), Slow())
        let compass = Compass(source: source, store: store)
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass, seen)
        try await source.started(1)
        source.play(events)
        try await eventually { seen.value.count == 1500 }
        #expect(seen.value.last?.reading.status == .tracking && store.kept.value != nil)
        compass.reset()
        await compass.settled()
        #expect(store.kept.value == nil)
        source.play(flat(1500))
        try await eventually { seen.value.count == 1501 }
        #expect(seen.value.last?.reading.status.label == "collecting")
        task.cancel()
        try await task.value
        try await eventually { source.state.value.ends == 1 }
        #expect(store.kept.value == nil, "nor is it saved again at the end")

        // before anything runs, too: the next launch is as the first
        let other = Slow()
        other.kept.change { $0 = "kept" }
        let before = Compass(source: Played(events: []), store: other)
        before.reset()
        await before.settled()
        #expect(other.kept.value == nil)
    }

    /// A phone that lies flat, beside what the system makes of it: its hard iron is 2 uT off in every axis.
    func lying(_ accuracy: SystemFieldSample.Accuracy, samples: Int = 20) -> [SensorSample] {
        (1...samples).flatMap { k -> [SensorSample] in
            let timeNs = Int64(k) * stepNs
            let noise = 0.2 * Double((k * 7) % 5 - 2)
            let raw = Vector3(x: hardIronUt.x + 10 + noise, y: hardIronUt.y + 28 - noise, z: hardIronUt.z - 40 + noise)
            let system = Vector3(
                x: raw.x - hardIronUt.x - 2, y: raw.y - hardIronUt.y + 2, z: raw.z - hardIronUt.z - 2)
            return [
                .up(UpSample(timeNs: timeNs, upMS2: Vector3(x: 0, y: 0, z: 9.81))),
                .systemField(SystemFieldSample(timeNs: timeNs, fieldUt: system, accuracy: accuracy)),
                .magnetic(MagneticSample(timeNs: timeNs, fieldUt: raw)),
            ]
        }
    }

    @Test func theSystemsHardIronGivesAHeadingAtOnce() async throws {
        let trueDeg = atan2(-10, 28.0) * 180 / Double.pi
        for accuracy in [SystemFieldSample.Accuracy.high, .medium, .low] {
            let readings = try await Compass(source: Played(events: lying(accuracy))).readings().collected()
            let first = try #require(readings.first?.reading.heading, "\(accuracy)")
            let sigma = try #require(first.headingSigmaDeg)
            #expect(abs((first.headingDeg - trueDeg).remainder(dividingBy: 360)) < 3 * sigma, "\(first), true \(trueDeg)")
            #expect(abs((first.headingDeg - trueDeg).remainder(dividingBy: 360)) > 2, "it is the system's, not our own")
            #expect((15...60).contains(sigma), "13 uT in 30: \(sigma)")
            #expect(readings.allSatisfy { $0.reading.heading != nil })
        }
        let without = Config(useReportedHardIron: false)
        let refused = try await Compass(source: Played(events: lying(.high)), config: without).readings().collected()
        #expect(refused.allSatisfy { $0.reading.heading == nil })
        // the system knows nothing, or its field is of another time
        var old = lying(.high)
        old[1] = .systemField(
            SystemFieldSample(timeNs: -5 * stepNs, fieldUt: Vector3(x: 10, y: 28, z: -40), accuracy: .high))
        for events in [lying(.uncalibrated), Array(old[..<3])] {
            let readings = try await Compass(source: Played(events: events)).readings().collected()
            #expect(readings.allSatisfy { $0.reading.heading == nil && $0.reading.status.label == "collecting" })
        }
    }

    /// The system's field comes every 50 ms and once, after a pause, later; samples come between.
    @Test func theSystemsFieldBelongsToASampleWithinItsOwnPeriod() async throws {
        func system(_ ms: Int64) -> SensorSample {
            let field = Vector3(x: 10, y: 28, z: -40)
            return .systemField(SystemFieldSample(timeNs: ms * 1_000_000, fieldUt: field, accuracy: .high))
        }
        func sample(_ ms: Int64) -> [SensorSample] {
            let raw = Vector3(x: hardIronUt.x + 10, y: hardIronUt.y + 28, z: hardIronUt.z - 40)
            return [
                .up(UpSample(timeNs: ms * 1_000_000, upMS2: Vector3(x: 0, y: 0, z: 9.81))),
                .magnetic(MagneticSample(timeNs: ms * 1_000_000, fieldUt: raw)),
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

    @Test func whatWasLearnedIsBetterThanTheSystems() async throws {
        let store = Slow()
        _ = try await Compass(source: Played(events: tumbling(1500)), store: store).readings().collected()
        let next = try await Compass(source: Played(events: lying(.high)), store: store).readings().collected()
        let first = try #require(next.first?.reading)
        #expect(abs(try #require(first.fieldUt).y - 28) < 1, "\(first)")
    }

    @Test func theStoreHasTheCalibrationWhenReadingsHaveEnded() async throws {
        let store = Slow()
        _ = try await Compass(source: Played(events: events), store: store).readings().collected()
        let calls = store.calls.value
        #expect(calls.last == "saved" && calls.filter { $0 == "saved" }.count >= 2, "\(calls)")
    }

    @Test func anAppThatEntersTheBackgroundSaves() async throws {
        let (source, store) = (Live(), Slow())
        let compass = Compass(source: source, store: store)
        compass.save()
        await compass.settled()
        #expect(store.calls.value == [], "nothing to save")
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass, seen)
        try await source.started(1)
        source.play(events)
        try await eventually { seen.value.count == 1500 }
        let before = store.kept.value
        compass.save()
        await compass.settled()
        #expect(store.kept.value != before, "what came after the save at first tracking")
        let calls = store.calls.value
        compass.save()
        await compass.settled()
        #expect(store.calls.value == calls, "not twice the same")
        task.cancel()
        try await task.value
    }

    /// A gate that opens when a call has come back; for a call that waits for the gate it never does.
    final class Gate: CalibrationStore {
        private let opened = DispatchSemaphore(value: 0)
        let entered = Shared(0)
        let opensInTime = Shared<[Bool]>([])

        func pass() {
            entered.change { $0 += 1 }
            let inTime = opened.wait(timeout: .now() + 20) == .success
            opensInTime.change { $0.append(inTime) }
        }

        func open() { opened.signal() }

        func load() -> String? { nil }

        func save(_ text: String) { pass() }

        func clear() {}
    }

    @Test func savingWaitsNeitherForTheStoreNorForASample() async throws {
        let (live, store, sensor, gated) = (Live(), Gate(), Gate(), Shared(false))
        struct Gated: MagneticFieldSource {
            let (live, sensor, gated): (Live, Gate, Shared<Bool>)

            // asked for while a sample is worked on
            var hiddenS: Double {
                if gated.value { sensor.pass() }
                return 0
            }

            func samples() -> SensorSamples { live.samples() }
        }
        let compass = Compass(source: Gated(live: live, sensor: sensor, gated: gated), store: store)
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass, seen)
        try await live.started(1)
        // the save at first tracking; the next comes 10 s later
        store.open()
        live.play(events.prefix(1800))
        try await eventually { seen.value.count == 900 }
        compass.save()
        compass.save()
        store.open()
        await compass.settled()
        #expect(store.opensInTime.value == [true, true], "the store was still at it when save() came back")

        gated.change { $0 = true }
        live.play(flat(900))
        try await eventually { sensor.entered.value == 1 }
        compass.save()
        sensor.open()
        store.open()
        try await eventually { seen.value.count == 901 }
        #expect(sensor.opensInTime.value == [true])
        gated.change { $0 = false }
        store.open()
        task.cancel()
        try await task.value
    }

    /// A run is at a sample when its reader leaves and another comes: that sample is not the other's.
    @Test func aReaderGetsNothingOfTheRunBeforeItsOwn() async throws {
        let (live, sensor, gated) = (Live(), Gate(), Shared(false))
        struct Gated: MagneticFieldSource {
            let (live, sensor, gated): (Live, Gate, Shared<Bool>)

            var hiddenS: Double {
                if gated.value { sensor.pass() }
                return 0
            }

            func samples() -> SensorSamples { live.samples() }
        }
        let compass = Compass(source: Gated(live: live, sensor: sensor, gated: gated))
        let first = reader(compass, Shared([]))
        try await live.started(1)
        gated.change { $0 = true }
        live.play(flat(0))
        try await eventually { sensor.entered.value == 1 }
        first.cancel()
        try await first.value
        let seen = Shared<[CompensatedReading]>([])
        let second = reader(compass, seen)
        gated.change { $0 = false }
        sensor.open()
        try await live.started(2)
        live.play(flat(1))
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
        var gone: CompensatedReadings.AsyncIterator? = compass.readings().makeAsyncIterator()
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
        // the feeding waits for room when it is left
        for _ in 1...3 {
            for try await _ in compass.readings(capacity: 1) {
                try await Task.sleep(for: .milliseconds(20))
                break
            }
        }
        let count = Shared(0)
        let task = Task {
            for try await _ in compass.readings(capacity: 1) { count.change { $0 += 1 } }
        }
        try await eventually { count.value == 500 }
        try await task.value
        #expect(asked.value == 4)
    }
}
