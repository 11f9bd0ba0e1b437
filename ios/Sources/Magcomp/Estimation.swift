import Foundation

/// A compensator that is made when first used and stays, what goes with its readings, and where its calibration is kept. One
/// run of events pushes; any thread may save or reset it meanwhile. The store works outside the lock, on a queue of its own, in the
/// order it was told.
final class Estimation: @unchecked Sendable {
    /// About what a crash costs; flash memory wears out with more.
    private static let saveEveryNs = 10e9
    /// As often as an eye sees.
    private static let lookEveryNs = 0.2e9
    /// A run that begins earlier than the one before ended, by more than sensors' delays, has another clock.
    private static let anotherClockNs = 1e9
    /// The system's field is beside a sample for as long as the next one takes to come: a row at 50 Hz while that is not known.
    private static let firstPeriodNs = 20e6
    /// The slowest a sensor is asked for; what is longer is a pause.
    private static let longestPeriodNs = 1e9

    private let config: CompensationConfig
    private let store: (any CalibrationStore)?
    private let frames: Locked<HeadingFrame>
    private let sleptS: @Sendable () -> Double
    private let unixTimeS: @Sendable () -> Int64
    /// The store's, one call at a time.
    private let queue = DispatchQueue(label: "org.magcomp.store", qos: .userInitiated)
    /// Calls of the store that are to come.
    private let calls = DispatchGroup()
    // what follows is used inside `lock` alone
    private let lock = NSLock()
    /// Nil before it is first used, and after a defect.
    private var compensator: Compensator?
    /// The defect that took it away.
    private var defect: MagcompError?
    private var currentFrame: HeadingFrame?
    private var systemField: SensorSample.SystemField?
    /// Time between the latest two of them.
    private var systemPeriodNs = firstPeriodNs
    /// Whether the system's hard iron would tell something: it was not told, and nothing was learned.
    private var wantsSystems = true
    /// Whether there is a calibration.
    private var isInForce = false
    /// What was taken over last.
    private var text: String?
    private var storeError: MagcompError?
    /// When it was looked last, seconds since 1970.
    private var lookedS: Int64?
    /// What was told of sleep.
    private var hiddenS: Double
    private var latestNs: Int64?
    /// Whether the next event is a run's first.
    private var begins = true
    /// What the store keeps, and the time of the sample it was saved at.
    private var saved: Correction?
    private var savedNs: Int64?
    private var resets = 0
    private var unseen: [DeviceVector] = []
    private var lookedNs: Int64?
    /// Whether anything else was told of where north is: asking what it is worth costs a call.
    private var isAided = false
    /// Nil while no pose was told.
    private var world: WorldTurn?
    /// Whether the store was told something that no run has waited for.
    private var isTold = false
    /// Gets all that the compensator is given.
    private var recording: Compass.Recording?

    init(
        _ config: CompensationConfig, store: (any CalibrationStore)?, hiddenS: @escaping @Sendable () -> Double = { 0 },
        unixTimeS: @escaping @Sendable () -> Int64 = systemUnixTimeS, frames: Locked<HeadingFrame>
    ) {
        (self.config, self.store, self.frames) = (config, store, frames)
        (sleptS, self.unixTimeS, self.hiddenS) = (hiddenS, unixTimeS, hiddenS())
    }

    /// Records from now on. What was learned before goes into it as a kept calibration.
    func record(_ make: () throws -> Compass.Recording) throws -> Compass.Recording {
        try lock.withLock {
            if let recording, !recording.isOver {
                throw MagcompError.config(
                    field: "Compass.record", value: recording.urls[0].lastPathComponent,
                    expected: "one recording at a time; close that one first")
            }
            let made = try make()
            recording = made
            if let compensator {
                let now = unixTimeS()
                if let kept = try compensator.keep(unixTimeS: now) ?? text { made.kept(kept, unixTimeS: now) }
                if !begins { made.beginRun() }
                // the next sample tells it
                currentFrame = nil
            }
            return made
        }
    }

    /// A run of events begins: the first with what the store keeps, a later one with all that the one before has learned.
    func begin() async throws {
        let known = lock.withLock {
            beginRun()
            return (isThere: compensator != nil, resets: resets)
        }
        if known.isThere { return }
        let kept = await load()
        try lock.withLock {
            forget()
            recording?.reset()
            let made = try Compensator(config: config)
            // who resets meanwhile does not want what was kept before
            if let kept, resets == known.resets { try adopt(kept, made, unixTimeS()) }
            isInForce = try made.calibration() != nil
            compensator = made
        }
    }

    /// Inside `lock`.
    private func beginRun() { (begins, systemField, systemPeriodNs) = (true, nil, Self.firstPeriodNs) }

    /// Takes over what was kept; what is damaged or newer is told, and all is as at the first launch.
    private func adopt(_ kept: String, _ compensator: Compensator, _ unixTimeS: Int64) throws {
        recording?.kept(kept, unixTimeS: unixTimeS)
        do {
            try compensator.adoptKept(kept, unixTimeS: unixTimeS)
            text = kept
            saved = try Self.correction(of: compensator)
        } catch let error as MagcompError {
            switch error {
            case .keptDamaged, .keptNewer: storeError = error
            default: throw error
            }
        }
    }

    /// What the store keeps: asked for on its own queue, so it may take its time and may ask the compass anything.
    private func load() async -> String? {
        guard let store else { return nil }
        return await withCheckedContinuation { continuation in
            queue.async(group: calls) { continuation.resume(returning: store.load()) }
        }
    }

    /// Appends the answers to the magnetometer samples among events; those of a live source have a date.
    func push(_ events: [SensorSample], isLive: Bool, _ answers: inout [CompensatedReading]) throws {
        try lock.withLock {
            guard compensator != nil else { throw defect ?? MagcompError.closed }
            for event in events {
                guard var answer = try use({ try push(event, to: $0) }) ?? nil else { continue }
                if isLive { answer.timestamp = CompensatedReading.date(of: answer.sample) }
                answers.append(answer)
            }
        }
    }

    /// What is known while the source delivers nothing: neither field nor heading.
    func silent(after latest: CompensatedReading?) -> CompensatedReading {
        lock.withLock {
            world?.forgetAttitudes()
            return CompensatedReading(silentAfter: latest?.sample, storeError: storeError, unseenDirections: unseen)
        }
    }

    /// Tells the compensator what something else knows; false where there is none, or it came too late or too early.
    func aid(_ help: SensorSample) throws -> Bool {
        try lock.withLock { try use { try aid(help, $0) } ?? false }
    }

    private func aid(_ help: SensorSample, _ compensator: Compensator) throws -> Bool {
        // a pose that can't be throws, before the world sees it
        let isTaken = try compensator.take(help)
        if case .attitude(let pose) = help {
            world = world ?? WorldTurn()
            world?.see(pose)
        }
        if isTaken {
            isAided = true
            recording?.take(help)
        }
        return isTaken
    }

    /// Magnetic north in that world.
    var worldNorth: Compass.WorldNorth? { lock.withLock { world?.north } }

    func foundDeclination() throws -> Compass.FoundDeclination? {
        try lock.withLock { try use { try $0.foundDeclination() }.flatMap { $0 } }
    }

    /// Calls the compensator, inside `lock`; nil where there is none. After a defect there is none: this run ends, and the next one begins
    /// with what the store keeps.
    private func use<T>(_ call: (Compensator) throws -> T) throws -> T? {
        guard let compensator else { return nil }
        do {
            return try call(compensator)
        } catch let error as MagcompError {
            if case .panicked = error {
                self.compensator = nil
                defect = error
            }
            throw error
        }
    }

    /// Saves what the store does not keep already, without waiting: neither for the store nor for a sample that is being worked on.
    func save() {
        queue.async(group: calls) { [self] in lock.withLock { _ = saveChanged() } }
    }

    /// Saves, and waits until the store has it.
    func finish() async {
        lock.withLock { _ = saveChanged() }
        await settled()
    }

    /// Waits until the store has done all that it was told.
    func settled() async {
        await withCheckedContinuation { continuation in calls.notify(queue: queue) { continuation.resume() } }
    }

    /// Waits for what a run's own events have the store do: readings wait for the store.
    func settledIfTold() async {
        let told = lock.withLock {
            defer { isTold = false }
            return isTold
        }
        if told { await settled() }
    }

    /// As ``settled()``, for a thread that may wait.
    func settle() { calls.wait() }

    /// Inside `lock`, so that the store is told in the order things happened.
    private func tell(_ call: @escaping @Sendable (any CalibrationStore) -> Void) {
        guard let store else { return }
        isTold = true
        queue.async(group: calls) { call(store) }
    }

    /// Forgets the learned calibration, in the store too.
    func reset() {
        lock.withLock {
            resetLearned()
            resets += 1
            tell { $0.clear() }
        }
    }

    private func resetLearned() {
        forget()
        recording?.reset()
        // one that can't be reset is made anew by the next run
        do { try compensator?.reset() } catch { compensator = nil }
    }

    private func forget() {
        (currentFrame, latestNs, saved, savedNs, lookedNs) = (nil, nil, nil, nil, nil)
        (unseen, wantsSystems, isInForce) = ([], true, false)
        (text, storeError, lookedS, isAided, world) = (nil, nil, nil, false, nil)
    }

    /// The phone slept, and the events' times do not show it.
    private func noteSleep(_ compensator: Compensator) throws {
        let now = sleptS()
        guard now != hiddenS else { return }
        try push(sleptS: now - hiddenS, compensator)
        hiddenS = now
    }

    private func push(sleptS: Double, _ compensator: Compensator) throws {
        recording?.slept(sleptS)
        try compensator.pushGap(hiddenS: sleptS)
    }

    private func push(_ event: SensorSample, to compensator: Compensator) throws -> CompensatedReading? {
        if begins, !event.isNote {
            begins = false
            let isAnotherClock = latestNs.map { Double(event.timeNs) < Double($0) - Self.anotherClockNs } ?? false
            if isAnotherClock {
                recording?.beginClock()
                try startClock(compensator)
            }
            recording?.beginRun()
        }
        switch event {
        case .magnetic(let sample): return try push(sample, to: compensator)
        case .up(let sample): try compensator.pushUp(sample)
        case .rotationRate(let sample): try compensator.pushRotationRate(sample)
        case .systemField(let sample): see(sample)
        case .note(let note):
            try take(note.what, compensator)
            return nil
        case .heading, .attitude:
            _ = try aid(event, compensator)
            return nil
        }
        recording?.take(event)
        return nil
    }

    /// What a compass was told that was recorded.
    private func take(_ what: SensorSample.Note.What, _ compensator: Compensator) throws {
        switch what {
        case .run: beginRun()
        case .reset: resetLearned()
        case .kept(let text, let unixTimeS):
            try adopt(text, compensator, unixTimeS)
            isInForce = try compensator.calibration() != nil
        case .slept(let seconds): try push(sleptS: seconds, compensator)
        case .frame(let frame): frames.value = frame
        }
    }

    private func push(_ sample: SensorSample.Magnetic, to compensator: Compensator) throws -> CompensatedReading {
        try noteSleep(compensator)
        let wanted = frames.value
        if wanted != currentFrame {
            try compensator.setHeadingFrame(wanted)
            currentFrame = wanted
            recording?.frame(wanted)
        }
        recording?.take(.magnetic(sample))
        let told = wantsSystems ? withSystemsHardIron(sample) : sample
        let reading = try compensator.push(told)
        // of a sample that is refused nothing was taken, and its time may be any
        if case .rejected = reading.status {
        } else {
            isInForce = reading.fieldUt != nil
            world?.see(reading, sample.timeNs)
            if told != sample || reading.status == .tracking { wantsSystems = false }
            try nowAndThen(sample.timeNs, reading.status, compensator)
        }
        return CompensatedReading(
            reading: reading, sample: sample, systemField: systemField, unseenDirections: unseen,
            storeError: storeError, headingAid: isAided ? try compensator.headingAid() : nil)
    }

    private func see(_ sample: SensorSample.SystemField) {
        if let before = systemField {
            let apart = Self.apart(before.timeNs, sample.timeNs)
            // what was delivered twice tells nothing
            if apart > 0 { systemPeriodNs = apart <= Self.longestPeriodNs ? apart : Self.firstPeriodNs }
        }
        systemField = sample
    }

    /// The system's hard iron, raw less calibrated field, is better than none: a heading at once. Beside a calibration it is listened
    /// to only where the system itself is sure of it.
    private func withSystemsHardIron(_ sample: SensorSample.Magnetic) -> SensorSample.Magnetic {
        guard let systemField, systemField.accuracy != .uncalibrated, systemField.accuracy == .high || !isInForce,
            Self.apart(systemField.timeNs, sample.timeNs) <= systemPeriodNs
        else { return sample }
        let (raw, field) = (sample.fieldUt, systemField.fieldUt)
        var told = sample
        told.reportedHardIronUt = DeviceVector(x: raw.x - field.x, y: raw.y - field.y, z: raw.z - field.z)
        return told
    }

    /// The calibration stays, as old as the time since the latest run makes it; all else begins anew.
    private func startClock(_ compensator: Compensator) throws {
        let kept = try compensator.keep(unixTimeS: lookedS ?? unixTimeS()) ?? text
        try compensator.reset()
        let before = saved
        if let kept { try adopt(kept, compensator, unixTimeS()) }
        saved = before
        (currentFrame, lookedNs, wantsSystems) = (nil, nil, true)
        savedNs = savedNs.map { _ in .min }
    }

    private func nowAndThen(_ timeNs: Int64, _ status: CompensationStatus, _ compensator: Compensator) throws {
        latestNs = timeNs
        let since = savedNs
        if since == nil, status == .tracking {
            _ = saveChanged()
            savedNs = timeNs
        }
        if lookedNs.map({ Self.apart(timeNs, $0) >= Self.lookEveryNs }) ?? true {
            (lookedNs, lookedS) = (timeNs, unixTimeS())
            unseen = try compensator.unseenDirections()
            if let since, Self.apart(timeNs, since) >= Self.saveEveryNs, saveChanged() { savedNs = timeNs }
        }
    }

    /// Nanoseconds between two times; the clock may have begun anew between them, so either may be the later.
    private static func apart(_ oneNs: Int64, _ otherNs: Int64) -> Double { abs(Double(oneNs) - Double(otherNs)) }

    /// Whether there was anything to save that was learned and that the store does not keep already.
    private func saveChanged() -> Bool {
        // after a defect there is nothing to keep
        guard store != nil, let compensator, let found = try? Self.correction(of: compensator), found != saved,
            let kept = try? compensator.keep(unixTimeS: unixTimeS())
        else { return false }
        tell { $0.save(kept) }
        (saved, storeError) = (found, nil)
        return true
    }

    private static func correction(of compensator: Compensator) throws -> Correction? {
        try compensator.calibration().map(Correction.init)
    }

    /// The compensator's, for tests alone.
    var fastHandle: Int64? { lock.withLock { compensator?.fastHandle } }
}

/// What corrects a sample: of a calibration all but the field strength, which follows the noise of a device at rest.
struct Correction: Equatable {
    private let softIron: SoftIron
    private let hardIronUt: DeviceVector

    init(_ calibration: MagnetometerCalibration) { (softIron, hardIronUt) = (calibration.softIron, calibration.hardIronUt) }
}

/// Seconds since 1970.
@Sendable func systemUnixTimeS() -> Int64 { Int64(Date().timeIntervalSince1970) }
