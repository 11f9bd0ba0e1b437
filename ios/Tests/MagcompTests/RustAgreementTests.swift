import Foundation
@_spi(Research) import Magcomp
import Testing

/// Rust's numbers, uniffi's and the C path's are the same, bit for bit; `examples/expected.rs` wrote Rust's, which Kotlin
/// compares with too.
@Suite struct RustAgreementTests {
    let expected: [Substring: [Substring]]
    let recording: RecordingSource

    init() throws {
        let lines = try String(contentsOf: prepared("expected.txt"), encoding: .utf8).split(separator: "\n")
        expected = Dictionary(grouping: lines) { $0.prefix { $0 != " " } }
        recording = RecordingSource(url: try prepared("recording.csv"))
    }

    @Test func aRecordingEventByEvent() async throws {
        let compensator = try Compensator()
        let readings = try compensator.pushAll(await recording.samples().collected())
        expectReadings(readings)
        #expect(readings.contains { $0.heading != nil && $0.status == .tracking }, "the recording shows something")
    }

    @Test func aRecordingOverUniffi() async throws {
        let native = try NativeCompensator(config: CompensationConfig())
        var readings: [MagneticReading] = []
        let compensator = try Compensator()
        for try await event in recording.samples() {
            switch event {
            case .magnetic(let sample):
                let reading = try native.push(sample: sample)
                readings.append(reading)
                #expect(try compensator.push(sample) == reading, "every field, status and its data too")
            // the C path answers false where uniffi throws
            case .rotationRate(let sample):
                let used = (try? native.pushRotationRate(sample: sample)) != nil
                #expect(try compensator.pushRotationRate(sample) == used)
            case .up(let sample):
                let used = (try? native.pushUp(sample: sample)) != nil
                #expect(try compensator.pushUp(sample) == used)
            case .systemField, .heading, .attitude, .note: Issue.record("a recording has none")
            }
        }
        expectReadings(readings)
    }

    @Test func aRecordingAsASequence() async throws {
        let readings = try await recording.samples().compensated().collected()
        #expect(readings.allSatisfy { $0.droppedBefore == 0 })
        expectReadings(readings.map(\.reading))
    }

    @Test func fitsOfTheGoldenVectors() throws {
        struct Ellipsoids: Decodable {
            struct Case: Decodable {
                let name: String
                let pointsUt: [[Double]]
            }
            let cases: [Case]
        }
        let cases = try vectors("ellipsoid.json", as: Ellipsoids.self).cases
        let ours = try cases.map { fit in
            let session = ConstantField(samplesPerOrientation: 1)
            for point in fit.pointsUt { try session.add(rawUt: DeviceVector(point)) }
            let name = "fit " + fit.name.replacingOccurrences(of: " ", with: "_")
            do {
                let found = try session.finish(options: nil).calibration
                let (m, b) = (found.softIron, found.hardIronUt)
                return name + bits([b.x, b.y, b.z, m.xx, m.yy, m.zz, m.xy, m.xz, m.yz, found.fieldStrengthUt])
            } catch MagcompError.fit {
                return name + bits([nil])
            }
        }
        #expect(ours == expected["fit"]?.map(String.init))
    }

    @Test func headingsOfTheGoldenVectors() throws {
        struct Headings: Decodable {
            struct Attitude: Decodable {
                let fieldUt, up: [Double]
            }
            let attitudes: [Attitude]
        }
        let attitudes = try vectors("headings.json", as: Headings.self).attitudes
        let ours = try attitudes.enumerated().map { number, attitude in
            var all: [Double?] = []
            for axis in [HeadingFrame.ReferenceAxis.topEdge, .camera, .auto] {
                for rotation in [HeadingFrame.ScreenRotation.deg0, .deg90, .deg180, .deg270] {
                    let frame = HeadingFrame(axis: axis, screenRotation: rotation)
                    let found = try CompassHeading(
                        fieldUt: DeviceVector(attitude.fieldUt), up: DeviceVector(attitude.up), frame: frame)
                    all.append(found?.headingDeg)
                }
            }
            return "heading \(number)" + bits(all)
        }
        #expect(ours == expected["heading"]?.map(String.init))
    }

    @Test func headingsOfAttitudesComputedByHand() throws {
        struct Headings: Decodable {
            struct Fact: Decodable {
                let name: String
                let screenRotationDeg: Int
                let fieldUt, up: [Double]
                let inclinationDeg: Double
                let topEdgeDeg, cameraDeg, autoDeg: Double?
            }
            let facts: [Fact]
        }
        let facts = try vectors("headings.json", as: Headings.self).facts
        #expect(facts.count >= 12)
        for fact in facts {
            let rotation = [HeadingFrame.ScreenRotation.deg0, .deg90, .deg180, .deg270][fact.screenRotationDeg / 90]
            let axes: [(HeadingFrame.ReferenceAxis, Double?)] = [
                (.topEdge, fact.topEdgeDeg), (.camera, fact.cameraDeg), (.auto, fact.autoDeg),
            ]
            for (axis, wanted) in axes {
                let frame = HeadingFrame(axis: axis, screenRotation: rotation)
                let found = try CompassHeading(fieldUt: DeviceVector(fact.fieldUt), up: DeviceVector(fact.up), frame: frame)
                #expect((found == nil) == (wanted == nil), "\(fact.name)")
                guard let found, let wanted else { continue }
                #expect(abs((found.headingDeg - wanted).remainder(dividingBy: 360)) < 1e-9, "\(fact.name)")
                #expect(abs(try #require(found.inclinationDeg) - fact.inclinationDeg) < 1e-9, "\(fact.name)")
            }
        }
    }

    func expectReadings(_ readings: [MagneticReading]) {
        let ours = readings.map {
            let (field, heading, attitude) = ($0.fieldUt, $0.heading, $0.attitude)
            return "reading \($0.timeNs) \($0.status.label)"
                + bits([
                    field?.x, field?.y, field?.z, $0.totalFieldUt, heading?.headingDeg, heading?.headingSigmaDeg,
                    heading?.inclinationDeg, attitude?.w, attitude?.x, attitude?.y, attitude?.z, attitude?.sigmaDeg,
                    $0.sigmaT, Double($0.window), $0.coverage,
                ])
        }
        let theirs = expected["reading"] ?? []
        #expect(theirs.count == ours.count && ours.count > 1000)
        for (our, their) in zip(ours, theirs) where our != their {
            Issue.record("\(our), Rust: \(their)")
            return
        }
    }

    func bits(_ values: [Double?]) -> String {
        values.map { $0.map { " " + String($0.bitPattern, radix: 16) } ?? " -" }.joined()
    }
}
