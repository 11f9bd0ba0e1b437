import Magcomp
import Testing

/// When a calibration is saved.
@Suite struct SavingTests {
    /// A store that knows at which event it was called.
    final class Kept: CalibrationStore {
        struct State {
            var snapshot: String?
            var nowS = 0.0
            var savedS: [Double] = []
        }

        let state: Shared<State>

        init(_ snapshot: String? = nil) { state = Shared(State(snapshot: snapshot)) }

        var savedS: [Double] { state.value.savedS }

        func load() -> String? { state.value.snapshot }

        func save(_ snapshot: String) {
            state.change {
                $0.savedS.append($0.nowS)
                $0.snapshot = snapshot
            }
        }
    }

    /// Plays events to a store's compensator; `end` runs after the last, before the sequence ends.
    func readings(
        _ events: [SensorSample], _ store: Kept, end: @escaping @Sendable () -> Void = {}
    ) async throws -> [CompensatedReading] {
        let next = Shared(0)
        let played = SensorSamples {
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
        _ = try await readings(tumbling(2000), store) { atCrash.change { $0 = store.state.value.snapshot } }
        let next = try await readings(tumbling(1), Kept(atCrash.value))
        #expect(next.count == 1 && next[0].reading.fieldUt != nil, "calibrated from the first sample on")
    }

    @Test func itIsSavedWhenTrackingBeginsEvery10SecondsWhileItChangesAndAtTheEnd() async throws {
        let store = Kept()
        var events = tumbling(2500)
        // one that is rejected for its time, an hour back, changes no interval
        events.insert(moved(events[1001], byNs: -3_600_000_000_000), at: 1002)
        let readings = try await readings(events, store)
        #expect(readings.filter { $0.reading.status.label() == "rejected" }.count == 1)
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
        // what the store should know, from a compensator of our own
        var changedS: [Double] = []
        var latest, atRest: String?
        let compensator = try Compensator()
        for (k, event) in turned.enumerated() {
            _ = try compensator.push(event)
            let snapshot = try compensator.snapshotCalibration()
            if snapshot != latest { changedS.append(seconds(event)) }
            latest = snapshot
            if k == rested.count - 1 { atRest = snapshot }
        }
        let before = try #require(changedS.last { $0 <= 60 })
        let after = try #require(changedS.first { $0 > 60 })
        #expect(before < 20, "the data show a rest")

        let store = Kept()
        _ = try await readings(rested, store)
        #expect(try #require(store.savedS.last) <= before + 10.201, "\(store.savedS)")
        #expect(store.state.value.snapshot == atRest, "the last change was saved, though within 10 s of the save before")

        let again = Kept()
        _ = try await readings(turned, again)
        let first = try #require(again.savedS.first { $0 > 60 })
        #expect((0...0.201).contains(first - after), "10 s had long passed: changed at \(after), saved at \(first)")

        // a next launch that ends before the first magnetometer sample
        let next = Kept(atRest)
        _ = try await readings(Array(tumbling(1)[..<1]), next)
        #expect(next.savedS == [])
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
        guard case .magnetic(let last)? = tumbling(1500).last else { return [] }
        return samples.flatMap { k -> [SensorSample] in
            let timeNs = Int64(k + 1) * stepNs
            let noise = { (n: Int) in 0.1 * Double((k * n) % 11 - 5) }
            let field = Vector3(
                x: last.fieldUt.x + noise(3), y: last.fieldUt.y + noise(5), z: last.fieldUt.z + noise(7))
            return [
                .up(UpSample(timeNs: timeNs, upMS2: Vector3(x: 0, y: 0, z: 9.81))),
                .magnetic(MagneticSample(timeNs: timeNs, fieldUt: field)),
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
        case .rotationRate, .systemField: return event
        }
    }
}

private func seconds(_ event: SensorSample) -> Double { Double(event.timeNs) * 1e-9 }
