import Foundation
@_spi(Research) @testable import Magcomp
import Testing

@Suite struct CompensatedTests {
    let events = tumbling(1500)

    struct Broken: Error, Equatable {}

    final class Kept: CalibrationStore {
        let text: Shared<String?>

        init(_ text: String? = nil) { self.text = Shared(text) }

        func load() -> String? { text.value }

        func save(_ text: String) { self.text.change { $0 = text } }

        func clear() { text.change { $0 = nil } }
    }

    @Test func aSlowIteratorLosesTheOldestReadingsCountedAndTheEstimatorNone() async throws {
        let source = Live()
        let compass = Compass(source: source)
        var slow = compass.readings(capacity: 5).makeAsyncIterator()
        slow.start()
        try await source.started(1)
        source.play(events)
        try await eventually { compass.latest?.sample.timeNs == events.last?.timeNs }
        // a reader gets a reading after `latest` has it, and all of them before the run is over
        source.finish()
        try await eventually { compass.latest == nil }
        var readings: [CompensatedReading] = []
        while let reading = try await slow.next() { readings.append(reading) }
        #expect(readings.map(\.droppedBefore) == [1495, 0, 0, 0, 0])
        #expect(try readings.last?.reading == Compensator().pushAll(events).last)
    }

    @Test func aFastIteratorLosesNone() async throws {
        let readings = try await Played(events: events).samples().compensated(capacity: 1500).collected()
        #expect(try readings.map(\.reading) == Compensator().pushAll(events))
        #expect(readings.allSatisfy { $0.droppedBefore == 0 })
    }

    @Test func itSaysWhichDirectionsAreUnseen() async throws {
        let readings = try await Played(events: events).samples().compensated(capacity: 1500).collected()
        let (first, last) = (try #require(readings.first), try #require(readings.last))
        #expect(first.unseenDirections.count > last.unseenDirections.count)
        #expect(first.unseenDirections.allSatisfy { abs($0.x * $0.x + $0.y * $0.y + $0.z * $0.z - 1) < 1e-9 })
        // renewed every 20 samples
        let changes = readings.indices.dropFirst().filter {
            readings[$0].unseenDirections != readings[$0 - 1].unseenDirections
        }
        #expect(!changes.isEmpty && changes.allSatisfy { $0 % 20 == 0 }, "\(changes)")
    }

    @Test func afterAStampAnHourAheadGuidanceGoesOn() async throws {
        var all = events
        guard case .magnetic(var astray) = all[199] else { throw Broken() }
        astray.timeNs += 3_600_000_000_000
        all.insert(.magnetic(astray), at: 200)
        let readings = try await Played(events: all).samples().compensated(capacity: 1600).collected()
        let unseen = try #require(readings.last).unseenDirections.count
        #expect(unseen < 24, "\(unseen) directions")
    }

    @Test func twoIteratorsHaveACompensatorEach() async throws {
        let sequence = Played(events: events).samples().compensated(capacity: 1500)
        async let first = sequence.collected()
        async let second = sequence.collected()
        let (one, other) = try await (first, second)
        // each was delivered at its own time
        func untimed(_ readings: [CompensatedReading]) -> [CompensatedReading] {
            readings.map {
                var reading = $0
                reading.timestamp = nil
                return reading
            }
        }
        #expect(untimed(one) == untimed(other) && one.count == 1500)
    }

    @Test func anySequenceOfSamplesCanBeCompensated() async throws {
        let (stream, continuation) = AsyncStream.makeStream(of: SensorSample.self)
        for event in events { continuation.yield(event) }
        continuation.finish()
        #expect(try await stream.compensated(capacity: 1500).collected().count == 1500)
    }

    @Test func anErrorOfTheSourceArrives() async throws {
        let events = events
        let samples = SensorSamples {
            AsyncThrowingStream<SensorSample, any Error> { continuation in
                continuation.yield(events[1])
                continuation.finish(throwing: Broken())
            }
        }
        var iterator = samples.compensated().makeAsyncIterator()
        #expect(try await iterator.next() != nil)
        await #expect(throws: Broken.self) { try await iterator.next() }
    }

    @Test func anErrorOfTheConfigArrives() async throws {
        let played = Played(events: events).samples()
        await #expect(throws: MagcompError.config(field: "capacity", value: "0", expected: "at least 1")) {
            try await played.compensated(capacity: 0).collected()
        }
        let config = CompensationConfig(windowed: WindowedConfig(nMin: 3))
        await #expect(throws: MagcompError.self) { try await played.compensated(config).collected() }
    }

    @Test func cancellingEndsAnEndlessSource() async throws {
        let (begun, ended) = (Shared(false), Shared(false))
        let endless = SensorSamples {
            AsyncStream<SensorSample> { continuation in
                begun.change { $0 = true }
                continuation.onTermination = { _ in ended.change { $0 = true } }
            }
        }
        let task = Task { try await endless.compensated().collected() }
        try await eventually { begun.value }
        task.cancel()
        #expect(try await task.value == [])
        try await eventually { ended.value }
    }

    @Test func anEndlessSourceThatNeverWaitsEndsWithItsIterator() async throws {
        struct Endless: AsyncSequence, AsyncIteratorProtocol, Sendable {
            let asked: Shared<Int64>

            func makeAsyncIterator() -> Endless { self }

            func next() async -> SensorSample? {
                asked.change { $0 += 1 }
                let v = DeviceVector(x: 1, y: 2, z: Double(asked.value % 7))
                return .magnetic(SensorSample.Magnetic(timeNs: asked.value * stepNs, fieldUt: v))
            }
        }
        let asked = Shared<Int64>(0)
        for try await _ in Endless(asked: asked).compensated() { break }
        // once it has ended, it is asked no more
        try await eventually {
            let before = asked.value
            Thread.sleep(forTimeInterval: 0.05)
            return asked.value == before
        }
    }

    @Test func theCalibrationIsKeptFromOneLaunchToTheNext() async throws {
        let store = Kept()
        _ = try await Compass(source: Played(events: events), store: store).readings().collected()
        #expect(try #require(store.text.value).count < 4000, "no more than the next launch takes over")
        let again = try await Compass(source: Played(events: Array(events[..<2])), store: store).readings().collected()
        #expect(again[0].reading.fieldUt != nil, "calibrated from the first sample on, though the clock began anew")
        #expect(again[0].reading.status.label != "rejected")
    }

    @Test func aDamagedStoreAndANewerVersionsAreAsNone() async throws {
        for text in ["", "{}", "nonsense", #"{"magcomp_calibration":99,"of":"a newer version"}"#] {
            let readings = Played(events: Array(events[..<2])).samples().compensated(store: Kept(text))
            #expect(try await readings.collected().map(\.reading.fieldUt) == [nil])
        }
    }

    @Test func userDefaultsKeepAText() {
        let key = "magcomp-test-\(UUID().uuidString)"
        defer { UserDefaults.standard.removeObject(forKey: key) }
        let store = UserDefaultsStore(key: key)
        #expect(store.load() == nil)
        store.save("a")
        store.save("b")
        #expect(UserDefaultsStore(key: key).load() == "b")
        #expect(UserDefaultsStore(key: key + "-other").load() == nil)
        store.clear()
        #expect(store.load() == nil)
    }

    @Test func anAppGroupsSuiteIsAStoreOfItsOwn() throws {
        let (key, suite) = ("magcomp-test-\(UUID().uuidString)", "org.magcomp.test")
        defer { UserDefaults(suiteName: suite)?.removeObject(forKey: key) }
        let (shared, own) = (UserDefaultsStore(suiteName: suite, key: key), UserDefaultsStore(key: key))
        shared.save("shared")
        #expect(own.load() == nil)
        #expect(UserDefaultsStore(suiteName: suite, key: key).load() == "shared")
        own.clear()
        #expect(shared.load() == "shared")
        shared.clear()
        #expect(shared.load() == nil)
    }

    @Test func aReadingHasTheDateOfItsSample() {
        let sample = SensorSample.Magnetic(timeNs: 99_750_000_000, fieldUt: DeviceVector(x: 1, y: 2, z: 3))
        let reading = CompensatedReading(reading: MagneticReading(status: .tracking), sample: sample)
        let now = Date(timeIntervalSince1970: 1_000_000)
        #expect(
            CompensatedReading.date(of: reading.sample, now: now, uptimeNs: 100_000_000_000).timeIntervalSince1970
                == 999_999.75)
    }

    /// A fact: however late it is asked for it is the same. A recording's times are not the device's.
    @Test func theDateIsThatOfTheSamplesComing() async throws {
        let uptimeNs = Int64(ProcessInfo.processInfo.systemUptime * 1e9)
        let event = SensorSample.magnetic(SensorSample.Magnetic(timeNs: uptimeNs, fieldUt: DeviceVector(x: 1, y: 2, z: 3)))
        let begin = Date()
        let live = try await Compass(source: Played(events: [event])).readings().collected()
        let date = try #require(live[0].timestamp)
        #expect(abs(date.timeIntervalSince(begin)) < 60)
        try await Task.sleep(for: .milliseconds(20))
        #expect(live[0].timestamp == date && live[0] == live[0])
        let played = try await Compass(source: Played(events: [event], isLive: false)).readings().collected()
        #expect(played[0].timestamp == nil && played[0].reading == live[0].reading)
    }

    @Test func readingsCanBeMadeAndCoded() throws {
        let heading = CompassHeading(headingDeg: 42, headingSigmaDeg: 3, trueHeadingDeg: nil, inclinationDeg: 60)
        let reading = MagneticReading(
            status: .suspect(sinceNs: 7), heading: heading, fieldUt: DeviceVector(x: 3, y: 4, z: 12))
        #expect(reading.totalFieldUt == 13)
        #expect(reading.headingDeg == 42 && reading.headingSigmaDeg == 3 && reading.trueHeadingDeg == nil)
        let simd = try SIMD3(#require(reading.fieldUt))
        #expect(simd == SIMD3(3, 4, 12) && DeviceVector(simd) == reading.fieldUt)
        let sample = SensorSample.Magnetic(timeNs: 1, fieldUt: DeviceVector(x: 1, y: 2, z: 3))
        let system = SensorSample.SystemField(timeNs: 1, fieldUt: DeviceVector(x: 1, y: 2, z: 3), accuracy: .high)
        let answer = CompensatedReading(reading: reading, sample: sample, systemField: system)
        let again = try JSONDecoder().decode(CompensatedReading.self, from: JSONEncoder().encode(answer))
        #expect(again == answer)
        let events: [SensorSample] = [.magnetic(sample), .systemField(system)]
        #expect(try JSONDecoder().decode([SensorSample].self, from: JSONEncoder().encode(events)) == events)
        let config = CompensationConfig(method: .windowed, heading: HeadingConfig(axis: .camera))
        #expect(try JSONDecoder().decode(CompensationConfig.self, from: JSONEncoder().encode(config)) == config)
    }

    @Test func theScreenMayTurnWhileReadingsCome() async throws {
        let half = events.count / 2
        // at last it lies flat: a turned screen is a turned heading
        let events = events + flat(1500)
        let turn: @Sendable (Compass) -> Void = { compass in
            (compass.axis, compass.screenRotation) = (.topEdge, .deg90)
            try? compass.setDeclinationDeg(3)
        }
        struct Turning: MagneticFieldSource {
            let events: [SensorSample]
            let turn: @Sendable (Int) -> Void

            func samples() -> SensorSamples {
                SensorSamples(isLive: false) { [events, turn] in
                    AsyncStream(unfolding: { [count = Shared(0)] in
                        let k = count.value
                        count.change { $0 += 1 }
                        turn(k)
                        return k < events.count ? events[k] : nil
                    })
                }
            }
        }
        let made = Shared<Compass?>(nil)
        let source = Turning(events: events) { if $0 == half { made.value.map(turn) } }
        let config = CompensationConfig(heading: HeadingConfig(axis: .topEdge))
        let compass = Compass(source: source, config: config)
        made.change { $0 = compass }
        let readings = try await compass.readings().collected().map(\.reading)
        let still = try Compensator(config: CompensationConfig(heading: HeadingConfig(axis: .topEdge))).pushAll(events)
        #expect(Array(readings[..<(half / 2)]) == Array(still[..<(half / 2)]))
        let (before, after) = (try #require(still.last?.heading), try #require(readings.last?.heading))
        // the vertical, which is filtered, comes to lie flat
        #expect(abs((after.headingDeg - before.headingDeg - 90).remainder(dividingBy: 360)) < 1e-3)
        #expect(after.trueHeadingDeg == CompassHeading.trueHeadingDeg(headingDeg: after.headingDeg, declinationDeg: 3))
    }

    @Test func aCompassHasTheConfigAndItsFrame() async throws {
        let heading = HeadingConfig(axis: .camera, screenRotation: .deg90, declinationDeg: 3)
        let config = CompensationConfig(method: .windowed, heading: heading)
        let compass = Compass(source: Played(events: events), config: config)
        #expect(compass.frame == HeadingFrame(axis: .camera, screenRotation: .deg90, declinationDeg: 3))
        let last = try await compass.readings().collected().last
        #expect(try last?.reading == Compensator(config: config).pushAll(events).last)
    }

    @Test func aCompassHasAFrameThatMayBeSet() async throws {
        let compass = Compass(source: Played(events: events))
        #expect(compass.frame == HeadingFrame(axis: .auto, screenRotation: .deg0))
        let first = try await compass.readings().collected().last
        // another one: this one goes on with what it has learned
        let upsideDown = Compass(source: Played(events: events))
        upsideDown.screenRotation = .deg180
        let second = try await upsideDown.readings().collected().last
        let turned = try #require(second?.reading.heading).headingDeg - (try #require(first?.reading.heading).headingDeg)
        #expect(abs((turned - 180).remainder(dividingBy: 360)) < 1e-9)
    }
}
