import Foundation
import Magcomp
import Testing

@Suite(.serialized) struct LimitsTests {
    let events = tumbling(1000)

    @Test func eightThreadsPushAndClose() throws {
        let wrong = Shared<[String]>([])
        let answered = Shared(0)
        for round in 0..<40 {
            let compensator = try Compensator()
            DispatchQueue.concurrentPerform(iterations: 8) { number in
                do {
                    for k in 0..<300 {
                        let timeNs = Int64(k * 8 + number + 1) * 1000
                        let v = DeviceVector(x: Double(k), y: 10, z: 20)
                        _ = try compensator.push(SensorSample.Magnetic(timeNs: timeNs, fieldUt: v))
                        try compensator.pushUp(SensorSample.Up(timeNs: timeNs, upMS2: DeviceVector(x: 0, y: 0, z: 9.8)))
                        answered.change { $0 += 1 }
                        if k % 50 == 10 { _ = try compensator.unseenDirections() }
                        if number == 7, k == 6 * round { compensator.close() }
                    }
                } catch MagcompError.closed {
                    // as it should
                } catch {
                    wrong.change { $0.append("\(error)") }
                }
            }
        }
        #expect(wrong.value == [])
        #expect(answered.value > 40 * 8, "\(answered.value) pushes got through")
    }

    @Test(.enabled(if: Self.hasProc, "Linux tells a process its memory")) func aMillionPushesDoNotGrowMemory() throws {
        let compensator = try Compensator()
        var offsetNs: Int64 = 0
        func round() throws {
            for event in events {
                guard case .magnetic(let sample) = event else { continue }
                let timeNs = sample.timeNs + offsetNs
                try compensator.pushRotationRate(
                    SensorSample.RotationRate(timeNs: timeNs, rateRadS: DeviceVector(x: 0.1, y: 0.2, z: 0.3)))
                try compensator.pushUp(SensorSample.Up(timeNs: timeNs, upMS2: DeviceVector(x: 0, y: 0, z: 9.8)))
                _ = try compensator.push(SensorSample.Magnetic(timeNs: timeNs, fieldUt: sample.fieldUt))
            }
            offsetNs += Int64(events.count) * stepNs
        }
        for _ in 0..<50 { try round() }
        let grown = try (0..<10).map { _ in
            let before = try residentBytes()
            for _ in 0..<100 { try round() }
            return try residentBytes() - before
        }
        // one byte lost in every push takes 16, and would show every time; what else the process does now and then
        #expect(grown.contains { $0 < 1_000_000 }, "resident memory grew by \(grown) bytes in 100 000 pushes each")
    }

    @Test(.enabled(if: Self.hasProc, "Linux tells a process its memory")) func compensatorsAreFreed() throws {
        func some() throws {
            for _ in 0..<100 {
                _ = try Compensator().push(SensorSample.Magnetic(timeNs: 1, fieldUt: DeviceVector(x: 1, y: 2, z: 3)))
            }
        }
        for _ in 0..<3 { try some() }
        let before = try residentBytes()
        // each has a window of 100 kB and more
        for _ in 0..<20 { try some() }
        let grown = try residentBytes() - before
        #expect(grown < 50_000_000, "resident memory grew by \(grown) bytes")
    }

    static let hasProc = FileManager.default.fileExists(atPath: "/proc/self/statm")

    func residentBytes() throws -> Int {
        let pages = try String(contentsOfFile: "/proc/self/statm", encoding: .utf8).split(separator: " ")[1]
        return try #require(Int(pages)) * 4096
    }
}
