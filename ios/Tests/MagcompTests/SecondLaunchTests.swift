import Foundation
@_spi(Research) @testable import Magcomp
import Testing

/// A compass is closed and opened again, through its store: what it says while the phone lies still.
@Suite struct SecondLaunchTests {
    let store = SavingTests.Kept()

    @Test func aTextOfUnknownAgeIsLessSureThanOneFromNow() throws {
        let learned = try Compensator()
        _ = try learned.pushAll(tumbling(900))
        let now = systemUnixTimeS()
        let text = try #require(try learned.keep(unixTimeS: now))
        let sigmas = try [now, nil].map { unixTimeS in
            let next = try Compensator()
            try next.adoptKept(text, unixTimeS: unixTimeS)
            return try #require(try next.pushAll(tumbling(1)).last?.fieldSigmaUt)
        }
        #expect(sigmas[1] > sigmas[0], "\(sigmas)")
    }

    @Test func headingsErrAsTheirSigmaSaysWhateverHappenedToThePhoneMeanwhile() async throws {
        let learned = try await learn()
        let cover = DeviceVector(x: 150, y: -100, z: 300)
        var (wrong, headings) = ([String](), 0)
        let phones = 16
        for offUt in [0, 20, 39, nil] as [Double?] {
            for k in 0..<phones {
                store.state.change { $0.text = learned }
                let turn = Double(k) * 2.4
                let direction = DeviceVector(x: 0.8 * cos(turn), y: 0.8 * sin(turn), z: k.isMultiple(of: 2) ? 0.6 : -0.6)
                let off = offUt.map { direction * $0 } ?? cover
                var phone = Phone(UInt64(k), hardIron: hardIronUt + off)
                phone.layDown(23 * Double(k))
                let readings = try await launched(&phone, 200, still: true, nowS: nowS + 3600)
                #expect(!readings.contains { $0.reading.status == .tracking }, "\(String(describing: offUt)), \(k)")
                #expect(store.state.value.text == learned, "nothing was learned")
                guard let heading = readings.last?.reading.heading else {
                    #expect(offUt != 0, "a heading is there")
                    continue
                }
                let sigmaDeg = try #require(heading.headingSigmaDeg)
                let errorDeg = abs((heading.headingDeg - phone.headingDeg).remainder(dividingBy: 360))
                headings += 1
                if errorDeg > 2 * sigmaDeg { wrong.append("\(off): \(errorDeg), \(sigmaDeg) deg") }
                if offUt == 0 { #expect(sigmaDeg <= 10, "of use") }
            }
        }
        #expect(Double(wrong.count) <= 0.1 * 4 * Double(phones), "\(wrong)")
        #expect(headings >= 2 * phones, "\(headings) headings")
    }

    @Test func itIsLearnedAgainWhereThePhoneIsTurnedAndSavedThen() async throws {
        let learned = try await learn()
        var phone = Phone(3, hardIron: hardIronUt + DeviceVector(x: 20, y: -10, z: 15))
        let readings = try await launched(&phone, 3000, still: false, nowS: nowS + 3600)
        #expect(readings.contains { $0.reading.status == .tracking })
        let text = try #require(store.state.value.text)
        #expect(text != learned)
        let again = try Compensator()
        try again.adoptKept(text, unixTimeS: nowS + 3600)
        #expect(abs(try #require(try again.calibration()).hardIronUt.x - hardIronUt.x - 20) < 3)
    }

    @Test func aKeptTextOfUnknownAgeIsBelievedLess() throws {
        let learned = try Compensator()
        _ = try learned.pushAll(tumbling(900))
        let text = try #require(try learned.keep(unixTimeS: nowS))
        let sigmas = try [nowS, nil].map { now in
            let again = try Compensator()
            try again.adoptKept(text, unixTimeS: now)
            return try #require(try again.pushAll(tumbling(3)).last?.fieldSigmaUt)
        }
        #expect(sigmas[1] > 1.5 * sigmas[0], "\(sigmas)")
    }

    @Test func theSystemsHardIronAndWhatWasGivenAreNeverSavedAsLearned() async throws {
        let none = SoftIron(xx: 1, yy: 1, zz: 1, xy: 0, xz: 0, yz: 0)
        let given = MagnetometerCalibration(softIron: none, hardIronUt: hardIronUt, fieldStrengthUt: 47.4)
        for (config, told) in [(CompensationConfig(), true), (CompensationConfig(initial: given), false)] {
            var phone = Phone(1, system: told ? .high : nil)
            phone.layDown(30)
            let readings = try await launched(&phone, 2000, still: true, config: config)
            #expect(readings.last?.reading.heading != nil, "it is in force")
            #expect(store.state.value.text == nil)
        }
    }

    @Test func aTextThatIsDamagedOrNewerIsToldUntilAnotherWasLearned() async throws {
        let learned = try await learn()
        for damaged in [String(learned.dropLast(20)), newer(learned)] {
            store.state.change { $0.text = damaged }
            var resting = Phone(2)
            resting.layDown(10)
            let last = try #require(try await launched(&resting, 50, still: true).last)
            #expect(last.reading.fieldUt == nil)
            switch last.storeError {
            case .keptDamaged?: #expect(damaged != newer(learned))
            case .keptNewer(found: 99)?: #expect(damaged == newer(learned))
            default: Issue.record("\(String(describing: last.storeError))")
            }
            #expect(store.state.value.text == damaged, "not overwritten by what was not learned")
            var turned = Phone(2)
            #expect(try await launched(&turned, 3000, still: false).last?.storeError == nil)
            #expect(store.state.value.text?.hasPrefix(#"{"magcomp_calibration":1,"#) == true)
        }
    }

    @Test func theSystemsHardIronIsHeardBesideAKeptCalibrationOnlyWhereTheSystemIsSureOfIt() async throws {
        let learned = try await learn()
        func offUt(_ system: SensorSample.SystemField.Accuracy?) async throws -> Double {
            store.state.change { $0.text = learned }
            var phone = Phone(4, hardIron: hardIronUt + DeviceVector(x: 22, y: -22, z: 22), system: system)
            phone.layDown(120)
            let readings = try await launched(&phone, 20, still: true, nowS: nowS + 3600)
            return (try #require(readings.last?.reading.fieldUt) + phone.field * -1).length
        }
        let alone = try await offUt(nil)
        #expect(try await offUt(.medium) == alone)
        #expect(try await offUt(.high) < 0.75 * alone)
    }

    @Test func aSourceWhoseTimesBeginAgainKeepsWhatWasInForceLearnedOrNot() async throws {
        let learned = try await learn()
        let clock = Shared(nowS + 3600)
        var resting = Phone(5)
        resting.layDown(80)
        let rest = (0..<300).flatMap { _ in resting.advance(still: true) }
        let compass = Compass(source: Played(events: rest), store: store, unixTimeS: { clock.value })
        try compass.setDeclinationDeg(2)
        let first = try await compass.readings(capacity: 300).collected().last?.reading.heading
        clock.change { $0 += 60 }
        let again = try await compass.readings(capacity: 300).collected()
        #expect(again.allSatisfy { $0.reading.status.label != "rejected" })
        let heading = try #require(again.last?.reading.heading)
        let before = try #require(first?.headingSigmaDeg)
        #expect(abs(try #require(heading.headingSigmaDeg) - before) < 1)
        #expect(heading.trueHeadingDeg == CompassHeading.trueHeadingDeg(headingDeg: heading.headingDeg, declinationDeg: 2))
        #expect(store.state.value.text == learned)

        var turned = Phone(6)
        let moving = (0..<3000).flatMap { _ in turned.advance(still: false) }
        let other = Compass(source: Played(events: moving), unixTimeS: { clock.value })
        _ = try await other.readings(capacity: 3000).collected()
        let soon = try #require(try await other.readings(capacity: 3000).collected().first?.reading.fieldSigmaUt)
        clock.change { $0 += 7 * 86_400 }
        let late = try await other.readings(capacity: 3000).collected().first?.reading.fieldSigmaUt ?? 1e9
        #expect(soon < 6 && late > 2 * soon, "\(late) after a week, \(soon) at once")
    }

    @Test func sleepThatTheSourceTellsMakesTheCalibrationLessSureOnce() async throws {
        struct Sleeping: MagneticFieldSource {
            let events: [SensorSample]
            let at: Int
            let sleptS: Double
            let slept = Shared(0.0)

            var hiddenS: Double { slept.value }

            func samples() -> SensorSamples {
                let (next, events, at, sleptS, slept) = (Shared(0), events, at, sleptS, slept)
                return SensorSamples(isLive: false) {
                    AsyncStream(unfolding: {
                        let k = next.value
                        next.change { $0 += 1 }
                        if k == at { slept.change { $0 = sleptS } }
                        return k < events.count ? events[k] : nil
                    })
                }
            }
        }
        func sigmas(sleptS: Double) async throws -> (before: Double, after: Double) {
            var phone = Phone(7)
            let moving = (0..<3000).flatMap { _ in phone.advance(still: false) }
            let events = moving + (0..<200).flatMap { _ in phone.advance(still: true) }
            let source = Sleeping(events: events, at: moving.count, sleptS: sleptS)
            let all = try await Compass(source: source).readings(capacity: 4000).collected()
            #expect(all.count == 3200)
            // once, with the first sample after it
            let alone = try Compensator(config: CompensationConfig(heading: HeadingConfig(axis: .auto)))
            var expected = try alone.pushAll(Array(events[..<(moving.count + 2)]))
            if sleptS > 0 { try alone.pushGap(hiddenS: sleptS) }
            expected += try alone.pushAll(Array(events[(moving.count + 2)...]))
            #expect(all.map(\.reading) == expected)
            return (try #require(all[2999].reading.fieldSigmaUt), all[3199].reading.fieldSigmaUt ?? 1e9)
        }
        let (awake, slept) = (try await sigmas(sleptS: 0), try await sigmas(sleptS: 8 * 3600))
        #expect(awake.before == slept.before && awake.after < 6, "\(awake)")
        #expect(slept.after > 2 * awake.after, "\(awake), \(slept)")
    }

    /// The text that a first launch keeps.
    func learn() async throws -> String {
        var phone = Phone(0)
        let readings = try await launched(&phone, 3000, still: false)
        #expect(readings.last?.reading.status == .tracking)
        return try #require(store.state.value.text)
    }

    /// The readings of one launch of an app.
    func launched(
        _ phone: inout Phone, _ samples: Int, still: Bool, nowS at: Int64 = nowS,
        config: CompensationConfig = CompensationConfig()
    ) async throws -> [CompensatedReading] {
        var events: [SensorSample] = []
        for _ in 0..<samples { events += phone.advance(still: still) }
        let compass = Compass(source: Played(events: events), config: config, store: store, unixTimeS: { at })
        let readings = try await compass.readings(capacity: samples).collected()
        #expect(readings.count == samples)
        return readings
    }
}

extension DeviceVector {
    static func + (one: DeviceVector, other: DeviceVector) -> DeviceVector {
        DeviceVector(x: one.x + other.x, y: one.y + other.y, z: one.z + other.z)
    }

    static func * (one: DeviceVector, factor: Double) -> DeviceVector {
        DeviceVector(x: one.x * factor, y: one.y * factor, z: one.z * factor)
    }

    var length: Double { (x * x + y * y + z * z).squareRoot() }
}

/// A phone with a gyroscope whose sensors have noise; turned about all axes, or lying still.
struct Phone {
    private let hardIron: DeviceVector
    /// What iOS says of its own field, which is right then.
    private let system: SensorSample.SystemField.Accuracy?
    private var state: UInt64
    /// The world's north and up in the device.
    private var (north, up) = (DeviceVector(x: 0, y: 1, z: 0), DeviceVector(x: 0, y: 0, z: 1))
    private var timeNs: Int64 = 0
    /// Of the top edge, where it lies flat.
    private(set) var headingDeg = 0.0
    /// Of the place, uT.
    var horizontalUt = 21.0

    init(_ seed: UInt64, hardIron: DeviceVector = hardIronUt, system: SensorSample.SystemField.Accuracy? = nil) {
        (state, self.hardIron, self.system) = (seed &* 2 &+ 1, hardIron, system)
    }

    /// The Earth's in the device, uT.
    var field: DeviceVector { north * horizontalUt + up * -43 }

    mutating func layDown(_ headingDeg: Double) {
        self.headingDeg = headingDeg
        let angle = headingDeg * .pi / 180
        (north, up) = (DeviceVector(x: -sin(angle), y: cos(angle), z: 0), DeviceVector(x: 0, y: 0, z: 1))
    }

    /// The next 10 ms.
    mutating func advance(still: Bool) -> [SensorSample] {
        let t = Double(timeNs) * 1e-9
        let rate =
            still
            ? DeviceVector(x: 0, y: 0, z: 0) : DeviceVector(x: sin(0.9 * t), y: cos(1.3 * t + 1), z: 0.8 * sin(0.5 * t))
        (north, up) = (Self.seen(north, rate), Self.seen(up, rate))
        timeNs += stepNs
        var events: [SensorSample] = [
            .rotationRate(SensorSample.RotationRate(timeNs: timeNs, rateRadS: noisy(rate, 0.003))),
            .up(SensorSample.Up(timeNs: timeNs, upMS2: noisy(up * 9.81, 0.05))),
        ]
        let raw = noisy(field + hardIron, 0.5)
        if let system {
            let calibrated = SensorSample.SystemField(timeNs: timeNs, fieldUt: raw + hardIron * -1, accuracy: system)
            events.append(.systemField(calibrated))
        }
        return events + [.magnetic(SensorSample.Magnetic(timeNs: timeNs, fieldUt: raw))]
    }

    private mutating func noisy(_ v: DeviceVector, _ size: Double) -> DeviceVector {
        v + DeviceVector(x: normal(), y: normal(), z: normal()) * size
    }

    /// Sum of twelve evenly spread numbers.
    private mutating func normal() -> Double {
        (0..<12).reduce(-6) { sum, _ in
            state = state &* 6_364_136_223_846_793_005 &+ 1_442_695_040_888_963_407
            return sum + Double(state >> 11) / 9_007_199_254_740_992
        }
    }

    /// A vector of the world as the device sees it after turning at a rate for 10 ms: Rodrigues' formula.
    private static func seen(_ v: DeviceVector, _ rate: DeviceVector) -> DeviceVector {
        let speed = rate.length
        guard speed > 0 else { return v }
        let axis = rate * (1 / speed)
        let (c, s) = (cos(0.01 * speed), sin(0.01 * speed))
        let cross = DeviceVector(
            x: axis.y * v.z - axis.z * v.y, y: axis.z * v.x - axis.x * v.z, z: axis.x * v.y - axis.y * v.x)
        let along = axis.x * v.x + axis.y * v.y + axis.z * v.z
        return v * c + cross * -s + axis * (along * (1 - c))
    }
}
