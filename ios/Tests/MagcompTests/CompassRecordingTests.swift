import Foundation
@testable import Magcomp
import MagcompTestHooks
import Testing

/// A live source that sleeps as a test says.
private struct Sleeping: MagneticFieldSource {
    let live = Live()
    /// Also before anybody had a compass.
    let slept = Shared(7200.0)

    var hiddenS: Double { slept.value }

    func samples() -> SensorSamples { live.samples() }
}

/// All of an answer but when it came.
private struct Seen: Equatable {
    let reading: MagneticReading
    let sample: SensorSample.Magnetic
    let systemField: SensorSample.SystemField?
    let unseen: [DeviceVector]
    let storeError: MagcompError?
    let aid: CompensatedReading.HeadingAid?

    init(_ answer: CompensatedReading) {
        (reading, sample, systemField) = (answer.reading, answer.sample, answer.systemField)
        (unseen, storeError, aid) = (answer.unseenDirections, answer.storeError, answer.headingAid)
    }
}

/// A recording plays as it was, whatever the compass was told meanwhile.
@Suite(.longest) struct CompassRecordingTests {
    private func file() -> URL { FileManager.default.temporaryDirectory.appendingPathComponent("\(UUID()).csv") }

    private func played(_ url: URL) async throws -> [Seen] {
        try await Compass(source: RecordingSource(url: url)).readings().collected().map(Seen.init)
    }

    /// As a phone: each sensor at its own times, iOS's field beside device motion.
    private func phone(_ samples: Int, from first: Int = 0, _ accuracy: SensorSample.SystemField.Accuracy = .high)
        -> [SensorSample]
    {
        let events = tumbling(first + samples).suffix(2 * samples).flatMap { event -> [SensorSample] in
            switch event {
            case .up(var up):
                up.timeNs += 3_000_000
                return [.up(up)]
            case .magnetic(let sample):
                let raw = sample.fieldUt
                let field = DeviceVector(x: raw.x - 120.5, y: raw.y + 80.25, z: raw.z - 300)
                let system = SensorSample.SystemField(timeNs: sample.timeNs + 3_000_000, fieldUt: field, accuracy: accuracy)
                return [event, .systemField(system)]
            default: return []
            }
        }
        return events.enumerated().sorted { ($0.element.timeNs, $0.offset) < ($1.element.timeNs, $1.offset) }.map(\.element)
    }

    /// A compass that is recorded from the beginning, and what was seen of it.
    private func live(
        _ url: URL, config: CompensationConfig = CompensationConfig(), store: (any CalibrationStore)? = nil,
        graceS: Double = 0,
        _ body: (Compass, Sleeping, Shared<[CompensatedReading]>) async throws -> Void
    ) async throws -> ([Seen], Compass.Recording) {
        let source = Sleeping()
        let compass = Compass(source: source, config: config, store: store, graceS: graceS, clock: StandingClock())
        let recording = try compass.record(to: url)
        let seen = Shared<[CompensatedReading]>([])
        try await run(compass, source, seen) { try await body(compass, source, seen) }
        try recording.close()
        return (seen.value.map(Seen.init), recording)
    }

    private func run(
        _ compass: Compass, _ source: Sleeping, _ seen: Shared<[CompensatedReading]>, _ body: () async throws -> Void
    ) async throws {
        let starts = source.live.state.value.starts
        let task = reader(compass, seen)
        try await source.live.started(starts + 1)
        try await body()
        source.live.finish()
        try await task.value
    }

    private func play(_ events: [SensorSample], _ source: Sleeping, _ seen: Shared<[CompensatedReading]>) async throws {
        let count = seen.value.count + events.count { if case .magnetic = $0 { true } else { false } }
        source.live.play(events)
        try await eventually { seen.value.count == count }
    }

    /// With what `Compass()` asks for: the first heading of all is by iOS's own field.
    @Test(arguments: [.high, .medium, .low, .uncalibrated] as [SensorSample.SystemField.Accuracy])
    func theAccuracyOfTheSystemsFieldIsInIt(_ accuracy: SensorSample.SystemField.Accuracy) async throws {
        let url = file()
        let (seen, recording) = try await live(url) { _, source, seen in
            try await play(phone(1500, accuracy), source, seen)
        }
        let again = try await played(url)
        #expect(again == seen && seen.count == 1500)
        let first = try #require(seen.firstIndex { $0.reading.headingDeg != nil })
        #expect(accuracy == .uncalibrated ? first > 10 : first < 5, "\(first)")
        #expect(recording.urls == [url] && recording.isOver)
    }

    @Test func theScreenSleepHelpAndAResetAreInIt() async throws {
        let (url, store) = (file(), Slow())
        var told: [SensorSample] = []
        let (seen, _) = try await live(url, store: store) { compass, source, seen in
            try await play(phone(400), source, seen)
            compass.screenRotation = .deg270
            try compass.setDeclinationDeg(-7.3)
            try await play(phone(100, from: 400), source, seen)
            let timeNs = seen.value[seen.value.count - 1].sample.timeNs
            let helpful = SensorSample.HeadedAxis.device(axis: DeviceVector(x: 0, y: 1, z: -0.1))
            let headings = [
                SensorSample.Heading(
                    timeNs: timeNs - 1_000_000_000, headingDeg: 91.25, sigmaDeg: 3, reference: .true, axis: .vehicle),
                SensorSample.Heading(
                    timeNs: timeNs + 25_000_000, headingDeg: 90, sigmaDeg: 4, reference: .magnetic, axis: helpful),
            ]
            for heading in headings {
                if try compass.aid(with: heading) { told.append(.heading(heading)) }
            }
            #expect(told.count == 2)
            try await play(phone(100, from: 500), source, seen)
            let yaws: [SensorSample.Attitude.WorldYaw] = [
                .relative, .absolute(sigmaDeg: 5, reference: .magnetic), .absolute(sigmaDeg: 6, reference: .true),
            ]
            for yaw in yaws {
                let latestNs = seen.value[seen.value.count - 1].sample.timeNs
                let pose = SensorSample.Attitude(timeNs: latestNs + 1, w: 0.5, x: 0.5, y: -0.5, z: 0.5, yaw: yaw)
                if try compass.aid(with: pose) { told.append(.attitude(pose)) }
                try await play(phone(20, from: seen.value.count), source, seen)
            }
            for sleptS in [1234.5, 60] {
                source.slept.change { $0 += sleptS }
                try await play(phone(100, from: seen.value.count), source, seen)
            }
            compass.axis = .camera
            try compass.setDeclinationDeg(nil)
            compass.reset()
            try await play(phone(300, from: seen.value.count), source, seen)
        }
        #expect(seen.contains { $0.reading.trueHeadingDeg != nil })
        let all = try await RecordingSource(url: url).samples().collected()
        let slept = all.compactMap { event -> Double? in
            if case .note(let note) = event, case .slept(let seconds) = note.what { seconds } else { nil }
        }
        #expect(slept == [1234.5, 60])
        let help = all.filter {
            switch $0 {
            case .heading, .attitude: true
            default: false
            }
        }
        #expect(help == told && told.count > 2)
        #expect(try await played(url) == seen)
        let text = try String(contentsOf: url, encoding: .utf8)
        // help of a later time moves no sample's row
        let rows = text.split(separator: "\n").map { $0.split(separator: ",", omittingEmptySubsequences: false) }
        let (field, own) = (try #require(rows[0].firstIndex(of: "mx")), try #require(rows[0].firstIndex(of: "own_t_s")))
        #expect(rows.dropFirst().allSatisfy { $0[field].isEmpty || $0[own].isEmpty })
        // each of them matters: without it other readings come
        for column in ["slept_s", "screen_deg", "declination_deg", "reset", "course_deg", "sys_accuracy", "own_t_s"] {
            let lines = text.split(separator: "\n", omittingEmptySubsequences: true).map(String.init)
            let at = try #require(lines[0].split(separator: ",").firstIndex { $0 == column })
            let named = lines[0].replacingOccurrences(of: column, with: "\(column)_other")
            #expect(lines.dropFirst().contains { !$0.split(separator: ",", omittingEmptySubsequences: false)[at].isEmpty })
            // who does not know a group of columns ignores all of it
            if ["screen_deg", "declination_deg", "course_deg"].contains(column) { continue }
            let other = file()
            try ([named] + lines.dropFirst()).joined(separator: "\n").write(to: other, atomically: true, encoding: .utf8)
            #expect(try await played(other) != seen, "\(column)")
        }
    }

    /// What the store gives is given again, a text that is damaged too; the second run goes on in the same file.
    @Test(arguments: [true, false]) func theStoresCalibrationAndTheNextRunAreInIt(isDamaged: Bool) async throws {
        let store = Slow()
        let learned = try Compensator()
        _ = try learned.pushAll(tumbling(900))
        let text = try #require(try learned.keep(unixTimeS: nowS))
        store.kept.change { $0 = isDamaged ? "damaged,\n\"so\r\n" : text }
        let url = file()
        let source = Sleeping()
        let compass = Compass(source: source, store: store, graceS: 0)
        let recording = try compass.record(to: url)
        let seen = Shared<[CompensatedReading]>([])
        for run in 0..<3 {
            // iOS's field comes before the first sample
            let events = Array(phone(200, from: 300 * run, .low).dropFirst())
            try await self.run(compass, source, seen) { try await play(events, source, seen) }
        }
        try recording.close()
        let again = try await played(url)
        #expect(
            again.map(\.reading) == seen.value.map(\.reading) && again.map(\.systemField) == seen.value.map(\.systemField))
        if isDamaged {
            guard case .keptDamaged = try #require(again[0].storeError) else { Issue.record("\(again[0])"); return }
        } else {
            #expect(again[0].reading.fieldUt != nil && again[0].storeError == nil)
        }
        #expect(recording.urls == [url])
    }

    @Test func aRecordingThatBeginsLaterHasWhatWasLearned() async throws {
        let (source, seen, url) = (Sleeping(), Shared<[CompensatedReading]>([]), file())
        let compass = Compass(source: source)
        try await run(compass, source, seen) {
            try await play(phone(900, .uncalibrated), source, seen)
            let recording = try compass.record(to: url)
            try await play(phone(2, from: 900, .uncalibrated), source, seen)
            try recording.close()
        }
        let again = try await played(url)
        #expect(again.map(\.sample) == seen.value.suffix(2).map(\.sample))
        #expect(again.allSatisfy { $0.reading.fieldUt != nil })
    }

    /// Late events, two of one time, a sample's own hard iron, any number: they go out as they came.
    @Test func eventsArePlayedInTheirOrderWithAllTheirBits() async throws {
        let v = DeviceVector(x: 0.1, y: -1e-7, z: 1e300)
        func ns(_ ms: Int64) -> Int64 { ms * 1_000_000 - 2_500_000_000 }
        func magnetic(_ timeNs: Int64, _ x: Double = 0.3) -> SensorSample {
            .magnetic(
                SensorSample.Magnetic(
                    timeNs: timeNs, fieldUt: DeviceVector(x: x, y: .nan, z: -.infinity), reportedHardIronUt: nil))
        }
        let reported = SensorSample.Magnetic(
            timeNs: 8, fieldUt: DeviceVector(x: 1, y: 2, z: 3), reportedHardIronUt: DeviceVector(x: 4, y: 5, z: 6))
        let events: [SensorSample] = [
            .rotationRate(SensorSample.RotationRate(timeNs: ns(0), rateRadS: v)),
            .up(SensorSample.Up(timeNs: ns(0), upMS2: v)),
            .systemField(SensorSample.SystemField(timeNs: ns(0), fieldUt: v, accuracy: .medium)), magnetic(ns(3)),
            magnetic(ns(2_500)), magnetic(7, 1), magnetic(7, 2),
            .up(SensorSample.Up(timeNs: 6, upMS2: v)), .rotationRate(SensorSample.RotationRate(timeNs: 6, rateRadS: v)),
            .magnetic(reported),
            magnetic(200 * 86_400 * 1_000_000_000 + 1), magnetic(.max), magnetic(.min), magnetic(.max - 1),
        ]
        let url = file()
        let (_, _) = try await live(url) { _, source, seen in try await play(events, source, seen) }
        let again = try await RecordingSource(url: url).samples().collected().filter { !$0.isNote }
        // NaN is not equal to itself
        #expect(again.map { "\($0)" } == events.map { "\($0)" })
    }

    @Test func aFileThatIsThereStaysAndAnotherClockBeginsAnother() async throws {
        let url = file()
        try Data("the tester's".utf8).write(to: url)
        let compass = Compass(source: Played(events: tumbling(300), isLive: false))
        let recording = try compass.record(to: url)
        // the second run begins before the first has ended
        let first = try await compass.readings().collected()
        let second = try await compass.readings().collected()
        #expect(first.count == 300 && second.count == 300 && second[0].reading.fieldUt != nil)
        #expect(throws: MagcompError.self) { try compass.record(to: url) }
        try recording.close()
        try recording.close()
        #expect(try String(contentsOf: url, encoding: .utf8) == "the tester's")
        let name = url.deletingPathExtension().lastPathComponent
        #expect(recording.urls.map(\.lastPathComponent) == ["\(name)-2.csv", "\(name)-3.csv"])
        #expect(try await played(recording.urls[0]) == first.map(Seen.init))
        // the second has the calibration that was known when it began, so it has its field at once
        let again = try await played(recording.urls[1])
        #expect(again.count == 300 && again[0].reading.fieldUt != nil)
        // one after the other, and each in a file of its own
        let next = try compass.record(to: url)
        try next.close()
        #expect(next.urls.map(\.lastPathComponent) == ["\(name)-4.csv"])
    }

    @Test func itIsWrittenWhileItGrowsAndEndsWhereItMayGrowNoMore() async throws {
        let (url, source) = (file(), Sleeping())
        let compass = Compass(source: source, graceS: 0)
        let recording = try compass.record(to: url, mostBytes: 100_000)
        let seen = Shared<[CompensatedReading]>([])
        try await run(compass, source, seen) {
            try await play(phone(300), source, seen)
            try await eventually { ((try? Data(contentsOf: url).count) ?? 0) > 16_000 }
            #expect(!recording.isOver)
            try await play(phone(1000, from: 300), source, seen)
        }
        #expect(recording.isOver)
        try recording.close()
        let bytes = try Data(contentsOf: url).count
        #expect((90_000...100_000).contains(bytes), "\(bytes)")
        // what is in it is whole
        let some = try await played(url)
        #expect(some.count > 300 && some == Array(seen.value[..<some.count]).map(Seen.init))
        // and another may begin, with what is known
        let rest = try compass.record(to: url)
        try await run(compass, source, seen) { try await play(phone(50, from: 1300), source, seen) }
        try rest.close()
        #expect(try await played(rest.urls[0]).count == 50)
    }

    @Test func whatCantBeWrittenIsAnErrorAndTheCompassGoesOn() async throws {
        let compass = Compass(source: Played(events: tumbling(1500), isLive: false))
        #expect(throws: CocoaError.self) { try compass.record(to: URL(fileURLWithPath: "/no/such/folder/r.csv")) }
        #expect(throws: MagcompError.self) { try compass.record(to: file(), mostBytes: 9_999) }
        // a disk that is full
        let full = try Compass.Recording(to: file(), mostBytes: 1_000_000) { _ in open("/dev/full", O_WRONLY) }
        _ = try compass.estimation.record { full }
        #expect(try await compass.readings().collected().count == 1500)
        #expect(throws: (any Error).self) { try full.close() }
        #expect(full.isOver)
        // so another may begin
        let next = Compass(source: Played(events: tumbling(300), isLive: false))
        try compass.record(to: file()).close()
        // another clock begins, and there is no room for another file
        let made = Shared(0)
        let one = try Compass.Recording(to: file(), mostBytes: 1_000_000) { path in
            made.change { $0 += 1 }
            if made.value == 1 { return open(path, O_WRONLY | O_CREAT, 0o644) }
            errno = ENOSPC
            return -1
        }
        _ = try next.estimation.record { one }
        for _ in 0..<2 { #expect(try await next.readings().collected().count == 300) }
        #expect(one.isOver && one.urls.count == 1)
        #expect(throws: CocoaError.self) { try one.close() }
        #expect(try await played(one.urls[0]).count == 300, "what was written before stays")
    }

    /// A compass that is gone ends its recording.
    @Test func whatNobodyClosesIsWrittenToo() async throws {
        let url = file()
        var compass: Compass? = Compass(source: Played(events: tumbling(300), isLive: false))
        try compass?.record(to: url)
        let seen = try #require(try await compass?.readings().collected()).map(Seen.init)
        compass = nil
        try await eventually { (try? String(contentsOf: url, encoding: .utf8))?.contains("\n3.000000000,") == true }
        #expect(try await played(url) == seen)
    }

    /// What was learned is lost, and the next run begins with what the store keeps.
    @Test func aDefectIsInIt() async throws {
        let (source, seen, url) = (Sleeping(), Shared<[CompensatedReading]>([]), file())
        let compass = Compass(source: source, store: Slow())
        let recording = try compass.record(to: url)
        let task = reader(compass, seen)
        try await source.live.started(1)
        try await play(phone(900), source, seen)
        #expect(magcomp_test_panic(try #require(compass.fastHandle)) == Int32(MAGCOMP_PANICKED))
        source.live.play(flat(900))
        await #expect(throws: MagcompError.self) { try await task.value }
        try await run(compass, source, seen) { try await play(phone(100, from: 901), source, seen) }
        try recording.close()
        #expect(try await played(url) == seen.value.map(Seen.init) && seen.value.count == 1000)
    }
}
