import Foundation
@_spi(Research) @testable import Magcomp
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
            ("t_s,mx,my,mz\n0,1,2,3,4\n", 2, nil, "5 cells, expected 4"),
            ("t_s,mx,my,mz,mx\n", 1, "mx", "the column is there twice"),
            (
                "t_s,mx,my,mz,ax,az\n", 1, "ay", "the column is missing; expected all of ax,ay,az or none"
            ),
            (
                "t_s,mx,my,mz,course_deg\n", 1, "course_sigma_deg",
                "the column is missing; expected all of course_deg,course_sigma_deg or none"
            ),
            ("t_s,mx,my,mz\n0,,,\n1,1,,3\n", 3, "my", "an empty cell, where others of the sensor have numbers"),
            ("t_s,mx,my,mz\n,1,2,3\n", 2, "t_s", "an empty cell, where others of the sensor have numbers"),
        ] as [(String, Int, String?, String)])
    func oneThatIsNotInOrderSaysWhere(text: String, line: Int, column: String?, problem: String) async {
        let error = RecordingSource.FileError(name: "r.csv", line: line, column: column, problem: problem)
        await #expect(throws: error) { try await source(text).samples().collected() }
    }

    @Test func rowsBeforeOneThatIsNotInOrderArrive() async throws {
        var iterator = source("t_s,mx,my,mz\n0,1,2,3\n1,4,5,6\n2,x,8,9\n").samples().makeAsyncIterator()
        for seconds in 0..<2 { #expect(try await iterator.next()?.timeNs == Int64(seconds) * 1_000_000_000) }
        await #expect(throws: RecordingSource.FileError.self) { try await iterator.next() }
    }

    @Test func compressedOnesSayWhatToDo() async throws {
        let source = RecordingSource(
            url: repository.appendingPathComponent("tests/recordings/broad_34_attached_magnet_3cm.csv.gz"))
        do {
            _ = try await source.samples().collected()
            Issue.record("no error")
        } catch let error as RecordingSource.FileError {
            #expect(error.localizedDescription.hasSuffix("it is compressed; decompress it with gunzip"))
        }
    }

    @Test func columnsMayComeInAnyOrderAndItCanBeIteratedAgain() async throws {
        // with the mark, the line ends and the empty last line of a spreadsheet
        let source = source("\u{FEFF}mz,note,mx,my,t_s,ax,ay,az\r\n3,?, 1,2,0.25,0,0,9.8\r\n\r\n")
        let expected: [SensorSample] = [
            .up(SensorSample.Up(timeNs: 250_000_000, upMS2: DeviceVector(x: 0, y: 0, z: 9.8))),
            .magnetic(SensorSample.Magnetic(timeNs: 250_000_000, fieldUt: DeviceVector(x: 1, y: 2, z: 3))),
        ]
        #expect(try await source.samples().collected() == expected)
        #expect(try await source.samples().collected() == expected)
    }

    /// As `magcomp import` writes it: each sensor at its own times, the system's field beside the magnetometer, courses now and then.
    @Test func eachSensorMayHaveItsOwnTimes() async throws {
        let text = """
            t_s,mx,my,mz,ax,ay,az,gx,gy,gz,sys_mx,sys_my,sys_mz,qw,qx,qy,qz,course_deg,course_sigma_deg
            0.000000000,,,,,,,0,0.2,1,,,,,,,,,
            0.003000000,1,2,3,,,,,,,4,5,6,1,0,0,0,,
            0.006000000,,,,0.1,0.2,9.8,,,,,,,,,,,,
            0.007000000,,,,,,,,,,,,,1,0,0,0,,
            0.010000000,7,8,9,,,,,,,,,,,,,,271,4

            """
        func event(_ ms: Int64, _ make: (Int64) -> SensorSample) -> SensorSample { make(ms * 1_000_000) }
        let expected = [
            event(0) { .rotationRate(SensorSample.RotationRate(timeNs: $0, rateRadS: DeviceVector(x: 0, y: 0.2, z: 1))) },
            event(3) {
                .systemField(
                    SensorSample.SystemField(timeNs: $0, fieldUt: DeviceVector(x: 4, y: 5, z: 6), accuracy: .uncalibrated))
            },
            event(3) { .magnetic(SensorSample.Magnetic(timeNs: $0, fieldUt: DeviceVector(x: 1, y: 2, z: 3))) },
            event(6) { .up(SensorSample.Up(timeNs: $0, upMS2: DeviceVector(x: 0.1, y: 0.2, z: 9.8))) },
            event(10) {
                .heading(
                    SensorSample.Heading(timeNs: $0, headingDeg: 271, sigmaDeg: 4, reference: .true, axis: .vehicle))
            },
            event(10) { .magnetic(SensorSample.Magnetic(timeNs: $0, fieldUt: DeviceVector(x: 7, y: 8, z: 9))) },
        ]
        #expect(
            try await source(text).samples().collected()
                == expected.filter { if case .heading = $0 { false } else { true } })
        let driven = RecordingSource(name: "r.csv", courses: .vehicle) { Data(text.utf8) }
        #expect(try await driven.samples().collected() == expected)
        // the system's own field is beside the readings, and begins nothing
        let readings = try await Compass(source: driven).readings().collected()
        #expect(readings.map(\.systemField?.fieldUt.x) == [4, 4] && readings.allSatisfy { $0.reading.fieldUt == nil })
    }

    /// A phone that lies flat, its calibration hardly known. A gyroscope carries north from one course to the next; without it none counts.
    @Test func coursesLeadTheHeadingWhereTheyAreAskedFor() async throws {
        let rows = (1...1500).map { k in
            let course = k % 50 == 0 ? "30,1" : ","
            return "\(Double(k) * 0.02),\(k % 2 == 0 ? 0.2 : -0.2),20,-45,0,0,9.81,0,0,0,\(course)"
        }
        let text = "t_s,mx,my,mz,ax,ay,az,gx,gy,gz,course_deg,course_sigma_deg\n" + rows.joined(separator: "\n")
        let config = CompensationConfig(
            initial: MagnetometerCalibration(
                softIron: SoftIron(xx: 1, yy: 1, zz: 1, xy: 0, xz: 0, yz: 0),
                hardIronUt: DeviceVector(x: 0, y: 0, z: 0), fieldStrengthUt: 49.244),
            initialSigmaUt: 30, heading: HeadingConfig(declinationDeg: 0))
        func last(_ headed: SensorSample.HeadedAxis?) async throws -> CompensatedReading {
            let source = RecordingSource(name: "r.csv", courses: headed) { Data(text.utf8) }
            return try #require(try await Compass(source: source, config: config).readings().collected().last)
        }
        let (led, alone) = (try await last(.device(axis: DeviceVector(x: 0, y: 1, z: 0))), try await last(nil))
        #expect(led.headingAid == .leads && alone.headingAid == nil)
        #expect(abs(try #require(led.reading.headingDeg) - 30) < 5)
        let own = try #require(alone.reading.headingDeg)
        #expect(min(own, 360 - own) < 5)
    }

    @Test func aRowIsGyroscopeThenUpThenMagnetometer() async throws {
        let source = source("t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n1,1,2,3,4,5,6,7,8,nan\n")
        let kinds = try await source.samples().collected().map { sample in
            switch sample {
            case .rotationRate(let sample): sample.rateRadS.z.isNaN ? "rate" : ""
            case .up: "up"
            case .magnetic: "magnetic"
            case .systemField: "system"
            case .heading, .attitude, .note: "help"
            }
        }
        #expect(kinds == ["rate", "up", "magnetic"])
    }

    /// Time goes on while it sleeps, and by a little at every look.
    final class Clock: WaitingClock {
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
