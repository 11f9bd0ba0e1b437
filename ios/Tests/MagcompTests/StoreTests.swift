import Foundation
@_spi(Research) @testable import Magcomp
import Testing

/// A compass and its store: what is kept when, and who waits for it.
@Suite(.longest) struct StoreTests {
    let events = tumbling(1500)

    /// As views come and go: the next run begins when the one before has saved, and loads nothing old.
    @Test func aHundredTurnsWithASlowStoreLoseNothing() async throws {
        let (source, store) = (Live(), Slow())
        let compass = Compass(source: source, store: store)
        let all = tumbling(4000)
        var readings: [MagneticReading] = []
        for run in 0..<100 {
            let seen = Shared<[CompensatedReading]>([])
            let task = reader(compass, seen)
            try await source.started(run + 1)
            source.play(all[(run * 80)..<((run + 1) * 80)])
            try await eventually { seen.value.count == 40 }
            // the last one ends when it has saved
            if run < 99 { task.cancel() } else { source.finish() }
            try await task.value
            readings += seen.value.map(\.reading)
        }
        #expect(source.state.value.ends == 100)
        #expect(try readings == Compensator(config: CompensationConfig(heading: HeadingConfig(axis: .auto))).pushAll(all))
        let calls = store.calls.value
        #expect(calls.first == "load" && calls.filter { $0 == "load" }.count == 1)
        let saves = calls.dropFirst()
        #expect(saves.count > 10 && saves.count.isMultiple(of: 2))
        #expect(saves.enumerated().allSatisfy { $1 == ($0.isMultiple(of: 2) ? "save" : "saved") }, "never two at once")
    }

    @Test func resetForgetsWhatWasLearnedInTheStoreToo() async throws {
        let (source, store) = (Live(), Slow())
        let compass = Compass(source: source, store: store)
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass, seen)
        try await source.started(1)
        source.play(events)
        try await eventually { seen.value.count == 1500 }
        await compass.settled()
        #expect(seen.value.last?.reading.status == .tracking && store.kept.value != nil)
        compass.reset()
        await compass.settled()
        #expect(store.kept.value == nil)
        source.play(flat(1500))
        try await eventually { seen.value.count == 1501 }
        #expect(seen.value.last?.reading.status.label == "collecting")
        source.finish()
        try await task.value
        #expect(store.kept.value == nil, "nor is it saved again at the end")

        // before anything runs, too: the next launch is as the first
        let other = Slow()
        other.kept.change { $0 = "kept" }
        let before = Compass(source: Played(events: []), store: other)
        before.reset()
        await before.settled()
        #expect(other.kept.value == nil)
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
        await compass.settled()
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

    @Test func savingWaitsNeitherForTheStoreNorForASample() async throws {
        let (source, store) = (Gated(), Gate())
        let compass = Compass(source: source, store: store)
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass, seen)
        try await source.live.started(1)
        // the save at first tracking; the next comes 10 s later
        store.open()
        source.live.play(events.prefix(1800))
        try await eventually { seen.value.count == 900 }
        compass.save()
        compass.save()
        store.open()
        await compass.settled()
        #expect(store.opensInTime.value == [true, true], "the store was still at it when save() came back")

        source.gated.change { $0 = true }
        source.live.play(flat(900))
        try await eventually { source.sensor.entered.value == 1 }
        compass.save()
        source.sensor.open()
        store.open()
        try await eventually { seen.value.count == 901 }
        #expect(source.sensor.opensInTime.value == [true])
        source.gated.change { $0 = false }
        store.open()
        task.cancel()
        try await task.value
    }
}
