import Foundation
@testable import Magcomp
import Testing

@Suite struct RecordingSourceTests {
    func source(_ text: String) -> RecordingSource { RecordingSource(name: "r.csv") { Data(text.utf8) } }

    @Test(
        arguments: [
            ("t_s,mx,my\n", 1, "mz", "the column is missing"),
            ("t_s,mx,my,mz\n0,1,2,3\n1,1,x,3\n", 3, "my", "'x' is no number"),
            ("t_s,mx,my,mz\n0,1,2\n", 2, nil, "3 cells, expected 4"),
            ("t_s,mx,my,mz\nnan,1,2,3\n", 2, "t_s", "the time is no number of seconds that fits 64 bits of nanoseconds"),
            ("t_s,mx,my,mz\n1e300,1,2,3\n", 2, "t_s", "the time is no number of seconds that fits 64 bits of nanoseconds"),
            ("", 1, nil, "the header is missing"),
        ] as [(String, Int, String?, String)])
    func oneThatIsNotInOrderSaysWhere(text: String, line: Int, column: String?, problem: String) async {
        let error = RecordingError(name: "r.csv", line: line, column: column, problem: problem)
        await #expect(throws: error) { try await source(text).samples().collected() }
    }

    @Test func compressedOnesSayWhatToDo() async throws {
        let source = RecordingSource(
            url: repository.appendingPathComponent("tests/recordings/broad_34_attached_magnet_3cm.csv.gz"))
        do {
            _ = try await source.samples().collected()
            Issue.record("no error")
        } catch let error as RecordingError {
            #expect(error.localizedDescription.hasSuffix("it is compressed; decompress it with gunzip"))
        }
    }

    @Test func columnsMayComeInAnyOrderAndItCanBeIteratedAgain() async throws {
        // with the mark, the line ends and the empty last line of a spreadsheet
        let source = source("\u{FEFF}mz,note,mx,my,t_s,ax,ay,az\r\n3,?, 1,2,0.25,0,0,9.8\r\n\r\n")
        let expected: [SensorSample] = [
            .up(UpSample(timeNs: 250_000_000, upMS2: DeviceVector(x: 0, y: 0, z: 9.8))),
            .magnetic(MagneticSample(timeNs: 250_000_000, fieldUt: DeviceVector(x: 1, y: 2, z: 3))),
        ]
        #expect(try await source.samples().collected() == expected)
        #expect(try await source.samples().collected() == expected)
    }

    @Test func aRowIsGyroscopeThenUpThenMagnetometer() async throws {
        let source = source("t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n1,1,2,3,4,5,6,7,8,nan\n")
        let kinds = try await source.samples().collected().map { sample in
            switch sample {
            case .rotationRate(let sample): sample.rateRadS.z.isNaN ? "rate" : ""
            case .up: "up"
            case .magnetic: "magnetic"
            case .systemField: "system"
            }
        }
        #expect(kinds == ["rate", "up", "magnetic"])
    }

    /// Time goes on while it sleeps, and by a little at every look.
    final class Clock: PlayingClock {
        let now = Shared<Int64>(5_000_000_000)
        let slept = Shared<[Int64]>([])

        var nowNs: Int64 {
            now.change { $0 += 1_000_000 }
            return now.value
        }

        func sleep(forNs ns: Int64) async {
            now.change { $0 += ns }
            slept.change { $0.append(ns) }
        }
    }

    @Test func itCanPlayAtTheRecordingsPace() async throws {
        let text = "t_s,mx,my,mz,ax,ay,az\n" + [7.0, 7.5, 8.5, 8.25, 10].map { "\($0),1,2,3,0,0,9.8\n" }.joined()
        let clock = Clock()
        let source = RecordingSource(name: "r.csv", speed: 0.5, clock: clock) { Data(text.utf8) }
        #expect(try await source.samples().collected().count == 10)
        // each row is due after the first by twice its time; looking takes 1 ms, and what is overdue waits for nothing
        #expect(clock.slept.value == [999_000_000, 1_999_000_000, 2_998_000_000])
        for speed in [0, -1, Double.nan, .infinity] {
            let source = RecordingSource(name: "r.csv", speed: speed) { Data(text.utf8) }
            let error = MagcompError.config(field: "RecordingSource.speed", value: "\(speed)", expected: "above 0")
            await #expect(throws: error) { try await source.samples().collected() }
        }
    }

    @Test func atAPaceNoReadingIsDropped() async throws {
        let source = RecordingSource(url: try prepared("recording.csv"), speed: 200)
        let readings = try await Compass(source: source).readings().collected()
        let all = try await RecordingSource(url: try prepared("recording.csv")).samples().collected()
        #expect(readings.allSatisfy { $0.droppedBefore == 0 })
        let config = CompensationConfig(heading: HeadingConfig(axis: .auto))
        #expect(try readings.map(\.reading) == Compensator(config: config).pushAll(all))
    }

    @Test func aFileThatIsMissingIsAnError() async {
        await #expect(throws: (any Error).self) {
            try await RecordingSource(url: URL(fileURLWithPath: "/no/such.csv")).samples().collected()
        }
    }
}
