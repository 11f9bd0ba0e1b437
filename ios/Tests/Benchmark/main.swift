// What a push costs: in bare Rust, over the C path (`Compensator`), over uniffi, on the same events of a recording, in
// turns. It asserts nothing: `tests/swift.sh benchmark` runs it.

import Foundation
@_spi(Research) import Magcomp
import MagcompTestHooks

let recording = RecordingSource(url: URL(fileURLWithPath: CommandLine.arguments[1]))
var all: [SensorSample] = []
for try await event in recording.samples() { all.append(event) }
let magnetic = all.filter { if case .magnetic = $0 { true } else { false } }

// calibrated after 100 samples, and only corrected from then on
let tumbled = (1...20_000).map { (k: Int) -> SensorSample in
    let (a, b, noise) = (Double(k) * 0.11, Double(k) * 0.031, 0.3 * sin(Double(k) * 12.9898))
    let field = DeviceVector(
        x: 50 * cos(a) * cos(b) + 120 + noise, y: 50 * sin(a) * cos(b) - 80 - noise, z: 50 * sin(b) + 300)
    return .magnetic(SensorSample.Magnetic(timeNs: Int64(k) * 10_000_000, fieldUt: field))
}

func keep(_ events: [SensorSample]) {
    magcomp_test_bare_add(-1, 0, 0, 0, 0)
    for event in events {
        switch event {
        case .magnetic(let s): magcomp_test_bare_add(0, s.timeNs, s.fieldUt.x, s.fieldUt.y, s.fieldUt.z)
        case .rotationRate(let s): magcomp_test_bare_add(1, s.timeNs, s.rateRadS.x, s.rateRadS.y, s.rateRadS.z)
        case .up(let s): magcomp_test_bare_add(2, s.timeNs, s.upMS2.x, s.upMS2.y, s.upMS2.z)
        case .systemField, .heading, .attitude, .note: break
        }
    }
}

@MainActor func time(_ body: () throws -> Void) rethrows -> Double {
    let begin = DispatchTime.now().uptimeNanoseconds
    try body()
    return Double(DispatchTime.now().uptimeNanoseconds - begin)
}

// what the answers amount to, so that nothing is left out
var seen = 0.0

@MainActor func overC(_ events: [SensorSample], _ config: CompensationConfig) throws -> Double {
    let compensator = try Compensator(config: config)
    return try time { for event in events { seen += try compensator.push(event)?.coverage ?? 0 } }
}

@MainActor func overUniffi(_ events: [SensorSample], _ config: CompensationConfig) throws -> Double {
    let native = try NativeCompensator(config: config)
    return try time {
        for event in events {
            switch event {
            case .magnetic(let sample): seen += try native.push(sample: sample).coverage
            case .rotationRate(let sample): try? native.pushRotationRate(sample: sample)
            case .up(let sample): try? native.pushUp(sample: sample)
            case .systemField, .heading, .attitude, .note: break
            }
        }
    }
}

func median(_ values: [Double]) -> Double { values.sorted()[values.count / 2] }

let rounds = 21
print("ns a push: median of \(rounds) rounds of the recording, in turns; in brackets: times bare Rust, median of the rounds")
let cases: [(name: String, method: CompensationMethod, code: Int32, events: [SensorSample])] = [
    ("default method, gyroscope, up and magnetometer", .auto, 0, all),
    ("paper's method, magnetometer alone", .windowed, 1, magnetic),
    ("constant calibration, magnetometer alone, a tumbled device", .constant, 2, tumbled),
]
for (name, method, code, events) in cases {
    keep(events)
    let config = CompensationConfig(method: method)
    var bare: [Double] = []
    var c: [Double] = []
    var uniffi: [Double] = []
    for round in 0..<(rounds + 2) {
        let b = Double(magcomp_test_bare_ns(code))
        let (ours, theirs) = (try overC(events, config), try overUniffi(events, config))
        // the first two warm up
        if round >= 2 {
            bare.append(b)
            c.append(ours)
            uniffi.append(theirs)
        }
    }
    print("\(name): \(events.count) pushes")
    for (way, values) in [("bare Rust", bare), ("Swift, Compensator (C)", c), ("Swift, uniffi", uniffi)] {
        let ns = String(format: "%9.0f", median(values) / Double(events.count))
        let ratio = String(format: "%.2f", median(zip(values, bare).map { $0 / $1 }))
        print("  \(way.padding(toLength: 24, withPad: " ", startingAt: 0))\(ns) ns  (\(ratio))")
    }
}

/// Elements one at a time, as they are asked for: events, or arrays of them.
struct Pulled<Element: Sendable>: AsyncSequence, AsyncIteratorProtocol, Sendable {
    let all: [Element]
    var at = 0

    func makeAsyncIterator() -> Self { self }

    mutating func next() async -> Element? {
        guard at < all.count else { return nil }
        at += 1
        return all[at - 1]
    }
}

struct OneByOne: MagneticFieldSource {
    let events: [SensorSample]

    func samples() -> SensorSamples { SensorSamples(isLive: false) { [events] in Pulled(all: events) } }
}

struct Together: MagneticFieldSource {
    let batches: [[SensorSample]]

    func samples() -> SensorSamples { .batches(isLive: false) { [batches] in Pulled(all: batches) } }
}

/// The events of a sample and those before it, and as many of these together as a recording has rows read at once.
let ofSamples = all.reduce(into: [[SensorSample]]()) { rows, event in
    if let time = rows.last?.last?.timeNs, time == event.timeNs {
        rows[rows.count - 1].append(event)
    } else {
        rows.append([event])
    }
}
let together = stride(from: 0, to: ofSamples.count, by: 32).map { k in
    ofSamples[k..<min(k + 32, ofSamples.count)].flatMap { $0 }
}

/// Of the whole process, as a compass works on several threads.
func processorNs() -> Double {
    var now = timespec()
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now)
    return Double(now.tv_sec) * 1e9 + Double(now.tv_nsec)
}

func read(_ source: any MagneticFieldSource) async throws -> Double {
    var sum = 0.0
    for try await answer in Compass(source: source).readings() { sum += answer.headingDeg ?? 0 }
    return sum
}

/// As a phone does: gyroscope and gravity come, then the sample; the next come when the reading has been seen.
func pushAndRead(_ rows: [[SensorSample]]) async throws -> Double {
    let source = PushedSource()
    var sum = 0.0
    var readings = Compass(source: source, graceS: 0).readings().makeAsyncIterator()
    readings.start()
    while source.listeners == 0 { await Task.yield() }
    for row in rows {
        source.push(Array(row.dropLast()))
        source.push(Array(row.suffix(1)))
        sum += try await readings.next()?.headingDeg ?? 0
    }
    return sum
}

/// The same for a screen, which shows 60 a second: the next sample comes when the main actor is free again. Without a model it is what
/// the benchmark itself costs.
func pushAndShow(_ rows: [[SensorSample]], isShown: Bool) async throws -> Double {
    let source = PushedSource()
    let model = await CompassModel(compass: Compass(source: source, graceS: 0))
    let running = isShown ? Task { await model.run() } : nil
    while isShown, source.listeners == 0 { await Task.yield() }
    for row in rows {
        source.push(Array(row.dropLast()))
        source.push(Array(row.suffix(1)))
        await MainActor.run {}
    }
    let heading = await model.headingDeg ?? 0
    running?.cancel()
    await running?.value
    return heading
}

func model(_ source: any MagneticFieldSource) async -> Double {
    let model = await CompassModel(compass: Compass(source: source))
    await model.run()
    return await model.headingDeg ?? 0
}

keep(all)
let ways: [(name: String, run: @MainActor () async throws -> Double)] = [
    ("bare Rust", { Double(magcomp_test_bare_ns(0)) }),
    ("Compensator", { try overC(all, CompensationConfig()) }),
    (
        "readings(), 32 rows at once",
        { try await Task.detached { [together] in try await read(Together(batches: together)) }.value }
    ),
    ("the same, on the main actor", { try await read(Together(batches: together)) }),
    (
        "readings(), as a phone",
        { try await Task.detached { [ofSamples] in try await pushAndRead(ofSamples) }.value }
    ),
    ("readings(), event by event", { try await Task.detached { [all] in try await read(OneByOne(events: all)) }.value }),
    ("the same, on the main actor", { try await read(OneByOne(events: all)) }),
    ("CompassModel.run(), 32 rows at once", { await model(Together(batches: together)) }),
    ("CompassModel.run(), event by event", { await model(OneByOne(events: all)) }),
    (
        "CompassModel.run(), as a phone",
        { try await Task.detached { [ofSamples] in try await pushAndShow(ofSamples, isShown: true) }.value }
    ),
    (
        "of that the benchmark's own",
        { try await Task.detached { [ofSamples] in try await pushAndShow(ofSamples, isShown: false) }.value }
    ),
]
var costs = Array(repeating: [Double](), count: ways.count)
for round in 0..<13 {
    for (k, way) in ways.enumerated() {
        let begin = processorNs()
        seen += try await way.run()
        // the first two warm up
        if round >= 2 { costs[k].append((processorNs() - begin) / Double(magnetic.count)) }
    }
}
// others on the machine add to a round and never take from it
let least = costs.map { $0.min() ?? 0 }
print("processor ns a sample with its events of gyroscope and up, by the ways of an app: least of 11 rounds, in turns")
for (k, way) in ways.enumerated() {
    let ns = String(format: "%9.0f", least[k])
    let ratio = String(format: "%.2f", least[k] / least[0])
    print("  \(way.name.padding(toLength: 40, withPad: " ", startingAt: 0))\(ns) ns  (\(ratio))")
}
exit(seen.isFinite ? 0 : 1)
