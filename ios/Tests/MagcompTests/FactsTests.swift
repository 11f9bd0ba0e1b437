import Foundation
@_spi(Research) import Magcomp
import Testing

/// The facts every language of the library agrees on, from the file Rust and Kotlin assert too.
@Suite struct FactsTests {
    struct Facts: Decodable {
        struct Correct: Decodable {
            let name: String
            let softIron, hardIronUt, rawUt, fieldUt: [Double]
        }
        struct NoCalibration: Decodable {
            let softIron: [Double]
            let fieldStrengthUt: Double
            let text: String
        }
        struct Gauge: Decodable {
            let softIron, hardIronUt: [Double]
            let fieldStrengthUt: Double
            let rawUt: [[Double]]
        }
        struct Attitude: Decodable {
            let name: String
            let fieldUt, up, attitude: [Double]
            let headingDeg, declinationDeg, trueHeadingDeg, inclinationDeg: Double
        }
        struct Limits: Decodable {
            let magneticUt, rotationRateRadS: [Double]
            // `convertFromSnakeCase` makes this of up_m_s2
            let upMS2, gapNs: [Double]
        }
        struct Words: Decodable {
            let name: String
            let text, begins: String?
        }
        let correct: [Correct]
        let noCalibration: [NoCalibration]
        let gauge: Gauge
        let headings: [Attitude]
        let limits: Limits
        let eventRejections, errors, borderErrors: [Words]
    }

    let facts: Facts

    init() throws { facts = try vectors("facts.json") }

    func softIron(_ m: [Double]) -> SoftIron { SoftIron(xx: m[0], yy: m[1], zz: m[2], xy: m[3], xz: m[4], yz: m[5]) }

    @Test func correcting() throws {
        #expect(!facts.correct.isEmpty)
        for fact in facts.correct {
            let calibration = MagnetometerCalibration(
                softIron: softIron(fact.softIron), hardIronUt: DeviceVector(fact.hardIronUt), fieldStrengthUt: 50)
            let field = try calibration.correct(DeviceVector(fact.rawUt))
            #expect(field.isClose(to: fact.fieldUt, within: 1e-12), "\(fact.name)")
        }
    }

    @Test func noCalibration() throws {
        #expect(!facts.noCalibration.isEmpty)
        for fact in facts.noCalibration {
            let calibration = MagnetometerCalibration(
                softIron: softIron(fact.softIron), hardIronUt: DeviceVector(x: 0, y: 0, z: 0),
                fieldStrengthUt: fact.fieldStrengthUt)
            #expect(throws: MagcompError.calibration(why: fact.text)) {
                try calibration.correct(DeviceVector(x: 1, y: 2, z: 3))
            }
        }
    }

    @Test func theGaugeIsTheSymmetricPositiveDefiniteMatrix() throws {
        let session = ConstantField(samplesPerOrientation: 1)
        for raw in facts.gauge.rawUt { try session.add(rawUt: DeviceVector(raw)) }
        let found = try session.finish(options: nil).calibration
        let m = found.softIron
        for (ours, theirs) in zip([m.xx, m.yy, m.zz, m.xy, m.xz, m.yz], facts.gauge.softIron) {
            #expect(abs(ours - theirs) < 1e-9)
        }
        #expect(found.hardIronUt.isClose(to: facts.gauge.hardIronUt, within: 1e-7))
        #expect(abs(found.fieldStrengthUt - facts.gauge.fieldStrengthUt) < 1e-7)
    }

    @Test func headings() throws {
        #expect(!facts.headings.isEmpty)
        for fact in facts.headings {
            let frame = HeadingFrame(axis: .topEdge, screenRotation: .deg0, declinationDeg: fact.declinationDeg)
            let found = try #require(
                try CompassHeading(fieldUt: DeviceVector(fact.fieldUt), up: DeviceVector(fact.up), frame: frame))
            #expect(abs(found.headingDeg - fact.headingDeg) < 1e-9, "\(fact.name)")
            #expect(abs(try #require(found.trueHeadingDeg) - fact.trueHeadingDeg) < 1e-9, "\(fact.name)")
            #expect(abs(try #require(found.inclinationDeg) - fact.inclinationDeg) < 1e-9, "\(fact.name)")
            let lies = try #require(try DeviceAttitude(fieldUt: DeviceVector(fact.fieldUt), up: DeviceVector(fact.up)))
            // a quaternion and its negative are the same attitude
            let product = zip([lies.w, lies.x, lies.y, lies.z], fact.attitude).reduce(0) { $0 + $1.0 * $1.1 }
            #expect(abs(abs(product) - 1) < 1e-12, "\(fact.name)")
        }
    }

    /// Sydney by the World Magnetic Model; the field of the Earth's core falls with the third power of the distance from its middle.
    @Test func theEarthsFieldOfAPlace() throws {
        let date = Date(timeIntervalSince1970: 1_770_000_000)
        func field(_ longitudeDeg: Double, heightM: Double) throws -> EarthMagneticField {
            try EarthMagneticField(latitudeDeg: -33.87, longitudeDeg: longitudeDeg, heightM: heightM, date: date)
        }
        let sydney = try field(151.21, heightM: 0)
        #expect((12..<14).contains(sydney.declinationDeg), "\(sydney)")
        #expect((55..<60).contains(sydney.totalFieldUt))
        #expect(try !(12..<14).contains(field(-151.21, heightM: 0).declinationDeg))
        let high = try field(151.21, heightM: 400_000).totalFieldUt / sydney.totalFieldUt
        #expect((0.81..<0.87).contains(high), "(6371 / 6771)^3 is 0.83: \(high)")
        #expect(throws: MagcompError.self) {
            try EarthMagneticField(latitudeDeg: 0, longitudeDeg: 0, date: Date(timeIntervalSince1970: .infinity))
        }
    }

    @Test func unitsByTheirLimits() throws {
        let limits = facts.limits
        let compensator = try Compensator()
        func push(_ timeNs: Double, _ x: Double) throws -> CompensationStatus {
            let field = DeviceVector(x: x, y: 0, z: 0)
            return try compensator.push(SensorSample.Magnetic(timeNs: Int64(timeNs), fieldUt: field)).status
        }
        #expect(try push(0, limits.magneticUt[0]).label == "collecting")
        guard case .rejected(.outOfRange) = try push(1, limits.magneticUt[1]) else { throw Unexpected() }
        guard case .rejected(.timeJump) = try push(limits.gapNs[1], 1) else { throw Unexpected() }
        #expect(try push(limits.gapNs[0], 1).label == "collecting")

        let other = try Compensator()
        func rate(_ timeNs: Int64, _ x: Double) throws -> Bool {
            try other.pushRotationRate(SensorSample.RotationRate(timeNs: timeNs, rateRadS: DeviceVector(x: x, y: 0, z: 0)))
        }
        #expect(try rate(1, limits.rotationRateRadS[0]))
        #expect(try !rate(2, limits.rotationRateRadS[1]))
        func up(_ timeNs: Int64, _ x: Double) throws -> Bool {
            try other.pushUp(SensorSample.Up(timeNs: timeNs, upMS2: DeviceVector(x: x, y: 0, z: 0)))
        }
        #expect(try up(1, limits.upMS2[0]))
        #expect(try !up(2, limits.upMS2[1]))
    }

    struct Unexpected: Error {}

    @Test func errors() throws {
        let rejections: [MagcompError.EventRejection] = [.notFinite, .outOfRange, .late, .duplicate, .ahead]
        #expect(rejections.map { $0.text } == facts.eventRejections.map(\.text))
        #expect(facts.errors.count == 3 && facts.borderErrors.count == 2)
        for fact in facts.errors + facts.borderErrors {
            let sentence = try #require(said(fact.name), "\(fact.name)")
            if let begins = fact.begins {
                #expect(sentence.hasPrefix(begins), "\(sentence)")
            } else {
                #expect(sentence == fact.text)
            }
        }
    }

    func said(_ name: String) -> String? {
        switch name {
        case "Config":
            failure { _ = try Compensator(config: CompensationConfig(windowed: WindowedConfig(nMin: 3))) }
        case "KeptDamaged": failure { try Compensator().adoptKept("nonsense", unixTimeS: nil) }
        case "KeptNewer": failure { throw MagcompError.keptNewer(found: 99) }
        case "Closed": failure { throw MagcompError.closed }
        case "Panicked": failure { throw MagcompError.panicked(what: "why") }
        default: nil
        }
    }

    func failure(_ body: () throws -> Void) -> String? {
        do {
            try body()
            return nil
        } catch {
            return error.localizedDescription
        }
    }
}
