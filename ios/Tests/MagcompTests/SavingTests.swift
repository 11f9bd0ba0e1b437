import Foundation
import Magcomp
import Testing

/// When a calibration is saved.
@Suite struct SavingTests {
    /// A store that knows at which event it was called.
    final class Kept: CalibrationStore {
        struct State {
            var text: String?
            var nowS = 0.0
            var savedS: [Double] = []
        }

        let state: Shared<State>

        init(_ text: String? = nil) { state = Shared(State(text: text)) }

        var savedS: [Double] { state.value.savedS }

        func load() -> String? { state.value.text }

        func save(_ text: String) {
            state.change {
                $0.savedS.append($0.nowS)
                $0.text = text
            }
        }

        func clear() { state.change { $0.text = nil } }
    }

    /// Plays events to a store's compensator; `end` runs after the last, before the sequence ends.
    func readings(
        _ events: [SensorSample], _ store: Kept, end: @escaping @Sendable () -> Void = {}
    ) async throws -> [CompensatedReading] {
        let next = Shared(0)
        // live ones would not wait for the store
        let played = SensorSamples(isLive: false) {
            AsyncStream(unfolding: {
                let k = next.value
                next.change { $0 += 1 }
                guard k < events.count else {
                    end()
                    return nil
                }
                store.state.change { $0.nowS = seconds(events[k]) }
                return events[k]
            })
        }
        return try await played.compensated(store: store, capacity: events.count).collected()
    }

    @Test func aSessionOf20SecondsThatACrashEndedIsThereAtTheNextLaunch() async throws {
        let (store, atCrash) = (Kept(), Shared<String?>(nil))
        _ = try await readings(tumbling(2000), store) { atCrash.change { $0 = store.state.value.text } }
        let next = try await readings(tumbling(1), Kept(atCrash.value))
        #expect(next.count == 1 && next[0].reading.fieldUt != nil, "calibrated from the first sample on")
    }

    @Test func itIsSavedWhenTrackingBeginsEvery10SecondsWhileItChangesAndAtTheEnd() async throws {
        let store = Kept()
        var events = tumbling(2500)
        // one that is rejected for its time, an hour back, changes no interval
        events.insert(moved(events[1001], byNs: -3_600_000_000_000), at: 1002)
        let readings = try await readings(events, store)
        #expect(readings.filter { $0.reading.status.label == "rejected" }.count == 1)
        let tracking = try #require(readings.first { $0.reading.status == .tracking })
        #expect(store.savedS.count == 4, "\(store.savedS)")
        #expect(store.savedS.first == Double(tracking.sample.timeNs) * 1e-9)
        #expect(store.savedS.last == 25)
        for (one, next) in zip(store.savedS, store.savedS.dropFirst().dropLast()) {
            #expect((9.999...10.201).contains(next - one), "\(store.savedS)")
        }
    }

    @Test func itIsNotSavedAgainUntilItHasChanged() async throws {
        let rested = tumbling(1500) + still(1500..<6000)
        let turned = rested + tumbling(600).map { moved($0, byNs: 6000 * stepNs) }
        let changedS = try changes(turned).map(\.seconds)
        #expect(try #require(changedS.last { $0 <= 60 }) < 40, "the data show a rest")
        let after = try #require(changedS.first { $0 > 60 })

        let again = Kept()
        _ = try await readings(turned, again)
        let first = try #require(again.savedS.first { $0 > 60 })
        #expect((0...0.201).contains(first - after), "10 s had long passed: changed at \(after), saved at \(first)")

    }

    @Test func aDeviceAtRestIsSavedNoMoreNorAtTheEndNorAtTheNextLaunch() async throws {
        let alone = tumbling(1500) + still(1500..<6000)
        for (rested, restsFromS) in [(alone, 40.0), (handHeld(moving: 2000, still: 4000), nil)] {
            let all = try changes(rested)
            let (changedS, calibration) = try #require(all.last)
            if let restsFromS {
                #expect(changedS < restsFromS, "the data show a rest")
            } else {
                // gravity teaches the gyroscope's bias at rest too, and with it the hard iron, by some nanotesla every few seconds
                let before = try #require(all.last { $0.seconds < 25 }).calibration.hardIronUt
                let (b, a) = (before, calibration.hardIronUt)
                #expect(max(abs(b.x - a.x), abs(b.y - a.y), abs(b.z - a.z)) < 0.1)
                #expect(all.count { $0.seconds > 25 } < 20)
            }
            let store = Kept()
            _ = try await readings(rested, store)
            #expect(try #require(store.savedS.last) <= changedS + 10.201, "\(store.savedS)")
            let kept = try Compensator()
            try kept.adoptKept(try #require(store.state.value.text), unixTimeS: nil)
            #expect(
                try kept.calibration()?.hardIronUt == calibration.hardIronUt,
                "the last change was saved, though within 10 s of the save before")
            // a next launch that ends before the first magnetometer sample
            let next = Kept(store.state.value.text)
            _ = try await readings(Array(rested[..<1]), next)
            #expect(next.savedS == [])
        }
        // or else the gyroscope's part is the same as the magnetometer's alone
        let events = handHeld(moving: 2000, still: 4000)
        let compensator = try Compensator()
        _ = try compensator.pushAll(Array(events[..<15_000]))
        let before = try compensator.calibration()
        _ = try compensator.pushAll(Array(events[15_000...]))
        #expect(try compensator.calibration() != before, "the field strength follows the noise")
    }

    /// When a compensator of our own changes hard iron or soft iron, and to what.
    func changes(_ events: [SensorSample]) throws -> [(seconds: Double, calibration: MagnetometerCalibration)] {
        let compensator = try Compensator()
        var latest: MagnetometerCalibration?
        return try events.compactMap { event in
            _ = try compensator.push(event)
            guard let found = try compensator.calibration() else { return nil }
            var correction = found
            correction.fieldStrengthUt = 1
            defer { latest = correction }
            return correction == latest ? nil : (seconds(event), found)
        }
    }

    /// A phone with a gyroscope, turned by hand for some samples and still from then on, and noise.
    func handHeld(moving: Int, still: Int) -> [SensorSample] {
        var (up, field) = (DeviceVector(x: 0, y: 0, z: 9.81), DeviceVector(x: 0, y: 22, z: -42))
        return (1...(moving + still)).flatMap { k -> [SensorSample] in
            let (t, timeNs) = (Double(k) * 0.01, Int64(k) * stepNs)
            func noisy(_ v: DeviceVector, _ size: Double) -> DeviceVector {
                let noise = { (n: Int) in size * (Double((k * n) % 11) - 5) / 3 }
                return DeviceVector(x: v.x + noise(3), y: v.y + noise(5), z: v.z + noise(7))
            }
            let rate =
                k <= moving
                ? DeviceVector(x: 0.8 * sin(0.9 * t), y: 0.9 * cos(0.7 * t), z: 0.7 * sin(1.3 * t + 1))
                : DeviceVector(x: 0, y: 0, z: 0)
            up = seen(up, rate)
            field = seen(field, rate)
            let raw = DeviceVector(x: field.x + 30, y: field.y - 20, z: field.z + 40)
            return [
                .rotationRate(SensorSample.RotationRate(timeNs: timeNs, rateRadS: noisy(rate, 0.002))),
                .up(SensorSample.Up(timeNs: timeNs, upMS2: noisy(up, 0.02))),
                .magnetic(SensorSample.Magnetic(timeNs: timeNs, fieldUt: noisy(raw, 0.3))),
            ]
        }
    }

    /// A vector of the world as the device sees it after turning at a rate for 10 ms: Rodrigues' formula.
    func seen(_ v: DeviceVector, _ rate: DeviceVector) -> DeviceVector {
        let speed = (rate.x * rate.x + rate.y * rate.y + rate.z * rate.z).squareRoot()
        guard speed > 0 else { return v }
        let (x, y, z) = (rate.x / speed, rate.y / speed, rate.z / speed)
        let (c, s) = (cos(0.01 * speed), sin(0.01 * speed))
        let along = (x * v.x + y * v.y + z * v.z) * (1 - c)
        return DeviceVector(
            x: v.x * c - (y * v.z - z * v.y) * s + x * along,
            y: v.y * c - (z * v.x - x * v.z) * s + y * along,
            z: v.z * c - (x * v.y - y * v.x) * s + z * along)
    }

    /// The core's business, seen from here: what was learned in another place fits this one too.
    @Test func aRestoredCalibrationAtRestWithoutGyroscopeIsNotSuspect() async throws {
        let store = Kept()
        _ = try await readings(tumbling(1500), store)
        let rest = still(0..<6000)
        let next = try await readings(rest, Kept(store.state.value.text))
        let labels = next.map { $0.reading.status.label }
        let suspect = labels.filter { $0 == "suspect" }.count
        #expect(labels.count == 6000 && suspect == 0, "suspect in \(suspect) of 6000 samples at rest")
        #expect(next.allSatisfy { $0.reading.heading != nil })
    }

    @Test func nothingIsSavedBeforeThereIsACalibration() async throws {
        let store = Kept()
        _ = try await readings(tumbling(20), store)
        #expect(store.savedS == [])
    }

    @Test func afterAStampAnHourAheadSavingGoesOn() async throws {
        let store = Kept()
        var events = tumbling(6500)
        events.insert(moved(events[199], byNs: 3_600_000_000_000), at: 200)
        _ = try await readings(events, store)
        #expect((8...12).contains(store.savedS.count), "\(store.savedS)")
    }

    /// A device that lies still where the tumbling of 1500 samples left it, and noise.
    func still(_ samples: Range<Int>) -> [SensorSample] {
        let before = tumbling(1500).suffix(2)
        guard case .up(let up)? = before.first, case .magnetic(let last)? = before.last else { return [] }
        return samples.flatMap { k -> [SensorSample] in
            let timeNs = Int64(k + 1) * stepNs
            let noise = { (n: Int) in 0.1 * Double((k * n) % 11 - 5) }
            let field = DeviceVector(
                x: last.fieldUt.x + noise(3), y: last.fieldUt.y + noise(5), z: last.fieldUt.z + noise(7))
            return [
                .up(SensorSample.Up(timeNs: timeNs, upMS2: up.upMS2)),
                .magnetic(SensorSample.Magnetic(timeNs: timeNs, fieldUt: field)),
            ]
        }
    }

    func moved(_ event: SensorSample, byNs: Int64) -> SensorSample {
        switch event {
        case .magnetic(var sample):
            sample.timeNs += byNs
            return .magnetic(sample)
        case .up(var sample):
            sample.timeNs += byNs
            return .up(sample)
        case .rotationRate, .systemField, .heading, .attitude, .note: return event
        }
    }
}

private func seconds(_ event: SensorSample) -> Double { Double(event.timeNs) * 1e-9 }
