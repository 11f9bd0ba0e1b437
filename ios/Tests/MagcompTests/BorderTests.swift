import Foundation
@_spi(Research) @testable import Magcomp
import MagcompTestHooks
import Testing

@Suite struct BorderTests {
    let events = tumbling(600)

    @Test func findsTheHardIronAndSaysWhyNotBefore() throws {
        let compensator = try Compensator()
        let readings = try compensator.pushAll(events)
        #expect(readings[0].status.label == "collecting")
        #expect(readings[0].fieldUt == nil)
        let last = try #require(readings.last)
        #expect(last.status == .tracking)
        #expect(abs(try #require(last.totalFieldUt) - 50) < 2)
        let hardIron = try #require(try compensator.calibration()).hardIronUt
        #expect(hardIron.isClose(to: [hardIronUt.x, hardIronUt.y, hardIronUt.z], within: 1))
        #expect(try compensator.fit() == nil)
        #expect(try compensator.covariance()?.count == 81)

        let paper = try Compensator(config: CompensationConfig(method: .windowed))
        _ = try paper.pushAll(events)
        #expect(try paper.fit()?.covariance.count == 81)
    }

    @Test func aWholeReadingOfTheMagnetometerAloneIsTheSameOverCAndUniffi() throws {
        let (compensator, native) = (try Compensator(), try NativeCompensator(config: CompensationConfig()))
        let alone = events.compactMap { event in
            if case .magnetic(let sample) = event { sample } else { nil }
        }
        #expect(try compensator.unseenDirections().count == 48)
        let over = try alone.map { try compensator.push($0) }
        #expect(try alone.map { try native.push(sample: $0) } == over)
        let unseen = try compensator.unseenDirections()
        #expect(try unseen == native.coverage().unseenDirections && !unseen.isEmpty && unseen.count < 48)
        #expect(over.contains { $0.modelOrder != nil && $0.directionSigmaDeg != nil && $0.worstSigmaDeg != nil })
    }

    @Test func theModeSaysWhichSensorsAreUsed() throws {
        for (gyroscope, up, mode) in [
            (true, true, MagneticReading.SensorMode.gyroscopeAndGravity), (true, false, .gyroscopeOnly),
            (false, true, .gravityOnly),
            (false, false, .magnetometerOnly),
        ] {
            let (compensator, native) = (try Compensator(), try NativeCompensator(config: CompensationConfig()))
            for k in 1...200 {
                let timeNs = Int64(k) * stepNs
                if gyroscope {
                    let rate = SensorSample.RotationRate(timeNs: timeNs, rateRadS: DeviceVector(x: 0.1, y: 0, z: 0))
                    try compensator.pushRotationRate(rate)
                    try native.pushRotationRate(sample: rate)
                }
                if up {
                    let sample = SensorSample.Up(timeNs: timeNs, upMS2: DeviceVector(x: 0, y: 0, z: 9.8))
                    try compensator.pushUp(sample)
                    try native.pushUp(sample: sample)
                }
                let sample = SensorSample.Magnetic(timeNs: timeNs, fieldUt: DeviceVector(x: 20, y: Double(k % 7), z: -40))
                let found = try compensator.push(sample).mode
                #expect(try found == native.push(sample: sample).mode)
                if k == 200 { #expect(found == mode) }
            }
        }
    }

    @Test func aConfigOutOfRangeIsATypedError() {
        #expect(
            throws: MagcompError.config(field: "windowed.n_min", value: "3", expected: "at least 9 samples")
        ) { try Compensator(config: CompensationConfig(windowed: WindowedConfig(nMin: 3))) }
    }

    @Test func theDefaultsAreTheCores() throws {
        let (plain, spelled) = (try Compensator(), try Compensator(config: .defaults))
        #expect(try plain.pushAll(events) == spelled.pushAll(events))
        #expect(try plain.keep(unixTimeS: nowS) == spelled.keep(unixTimeS: nowS))
    }

    @Test func aBadSampleIsRejectedAndChangesNothing() throws {
        let compensator = try Compensator()
        _ = try compensator.pushAll(events)
        let before = try #require(try compensator.keep(unixTimeS: nowS))
        let bad = DeviceVector(x: .nan, y: 0, z: 0)
        #expect(
            try compensator.push(SensorSample.Magnetic(timeNs: .max, fieldUt: bad)).status == .rejected(reason: .notFinite))
        let late = try compensator.push(SensorSample.Magnetic(timeNs: 5, fieldUt: DeviceVector(x: 1, y: 2, z: 3)))
        #expect(late.status == .rejected(reason: .timeNotAfter(timeNs: 5, latestNs: 600 * stepNs)))
        #expect(late.timeNs == 5)
        #expect(try !compensator.pushUp(SensorSample.Up(timeNs: 5, upMS2: DeviceVector(x: 0, y: 0, z: 9.8))), "too late")
        #expect(try !compensator.pushRotationRate(SensorSample.RotationRate(timeNs: 5, rateRadS: bad)))
        #expect(try compensator.keep(unixTimeS: nowS) == before)
    }

    @Test func theSystemsHardIronCanBeTheFirstCalibration() throws {
        let compensator = try Compensator()
        func push(_ timeNs: Int64, reported: Double) throws -> MagneticReading {
            let sample = SensorSample.Magnetic(
                timeNs: timeNs, fieldUt: DeviceVector(x: 127, y: 36, z: 0),
                reportedHardIronUt: DeviceVector(x: reported, y: 0, z: 0))
            return try compensator.push(sample)
        }
        #expect(try push(1, reported: 100).fieldUt?.isClose(to: [27, 36, 0], within: 1e-9) == true)
        #expect(try push(2, reported: 97).reportedHardIronJumpUt == 3)
    }

    @Test func anAdoptedCalibrationIsAsUnsureAsItIsSaidToBe() throws {
        let none = SoftIron(xx: 1, yy: 1, zz: 1, xy: 0, xz: 0, yz: 0)
        let calibration = MagnetometerCalibration(
            softIron: none, hardIronUt: DeviceVector(x: 120, y: -80, z: 300), fieldStrengthUt: 45)
        func first(_ sigmaUt: Double) throws -> Double? {
            let compensator = try Compensator()
            try compensator.adopt(calibration, hardIronSigmaUt: sigmaUt)
            return try compensator.push(SensorSample.Magnetic(timeNs: 1, fieldUt: DeviceVector(x: 120, y: -35, z: 300)))
                .fieldSigmaUt
        }
        #expect((3.0...6.0).contains(try #require(try first(3))))
        // the sample's own strength tells one of three axes
        #expect((20.0...60.0).contains(try #require(try first(30))))
        let compensator = try Compensator()
        #expect(throws: MagcompError.config(field: "hard_iron_sigma_ut", value: "0.0", expected: "0.01 to 1000.0 uT")) {
            try compensator.adopt(calibration, hardIronSigmaUt: 0)
        }
        #expect(try compensator.calibration() == nil)
    }

    @Test func afterClosingEveryUseIsATypedError() throws {
        let compensator = try Compensator()
        compensator.close()
        compensator.close()
        let v = DeviceVector(x: 1, y: 2, z: 3)
        let uses: [() throws -> Void] = [
            { _ = try compensator.push(SensorSample.Magnetic(timeNs: 1, fieldUt: v)) },
            { try compensator.pushUp(SensorSample.Up(timeNs: 1, upMS2: v)) },
            { try compensator.pushRotationRate(SensorSample.RotationRate(timeNs: 1, rateRadS: v)) },
            { _ = try compensator.calibration() },
            { _ = try compensator.unseenDirections() },
            { _ = try compensator.keep(unixTimeS: nowS) },
            { try compensator.adoptKept("", unixTimeS: nil) },
            { try compensator.pushGap(hiddenS: 1) },
            { try compensator.reset() },
        ]
        for use in uses {
            #expect(throws: MagcompError.closed) { try use() }
        }
    }

    @Test func aHandleOutlivesItsObjectAsANumberThatFindsNothing() throws {
        var compensator: Compensator? = try Compensator()
        let handle = try #require(compensator).fastHandle
        #expect(magcomp_push_up(handle, 1, 0, 0, 9.8) == 0)
        compensator = nil
        for stale in [handle, 0, -1, .max, .min] {
            #expect(magcomp_push_up(stale, 2, 0, 0, 9.8) == Int32(MAGCOMP_CLOSED))
            #expect(magcomp_push(stale, 2, 0, 0, 0, .nan, .nan, .nan, nil) == Int32(MAGCOMP_CLOSED))
            #expect(magcomp_unseen_directions(stale, nil) == Int32(MAGCOMP_CLOSED))
        }
        let other = try Compensator()
        #expect(other.fastHandle != handle)
        #expect(magcomp_push(other.fastHandle, 2, 0, 0, 0, .nan, .nan, .nan, nil) == Int32(MAGCOMP_NO_ROOM))
        #expect(magcomp_unseen_directions(other.fastHandle, nil) == Int32(MAGCOMP_NO_ROOM))
    }

    @Test func aDefectOfTheLibraryIsATypedErrorUntilReset() throws {
        let compensator = try Compensator()
        #expect(magcomp_test_panic(compensator.fastHandle) == Int32(MAGCOMP_PANICKED))
        let defect = MagcompError.panicked(what: "on purpose")
        let sample = SensorSample.Magnetic(timeNs: 1, fieldUt: DeviceVector(x: 1, y: 2, z: 3))
        #expect(throws: defect) { try compensator.push(sample) }
        #expect(throws: defect) { try compensator.calibration() }
        #expect(throws: defect) { try compensator.unseenDirections() }
        try compensator.reset()
        #expect(try compensator.push(sample).status.label == "collecting")
    }

    @Test func aKeptCalibrationIsInForceAgainLessSureWithItsAgeInAStreamThatGoesOn() throws {
        let first = try Compensator()
        #expect(try first.keep(unixTimeS: nowS) == nil, "nothing was learned")
        _ = try first.pushAll(events)
        let text = try #require(try first.keep(unixTimeS: nowS))
        let astray = SensorSample.Magnetic(timeNs: stepNs, fieldUt: DeviceVector(x: 1, y: 2, z: 3))
        func sigmaUt(_ ageS: Int64?) throws -> Double {
            let second = try Compensator()
            try second.setHeadingFrame(HeadingFrame(axis: .topEdge, screenRotation: .deg90, declinationDeg: 3))
            _ = try second.push(astray)
            try second.adoptKept(text, unixTimeS: ageS.map { nowS + $0 })
            #expect(try second.calibration()?.hardIronUt == first.calibration()?.hardIronUt)
            #expect(try second.keep(unixTimeS: nowS) == nil, "nothing was learned since")
            #expect(try second.push(astray).status.label == "rejected", "the clock goes on")
            let reading = try #require(try second.pushAll(flat(10)).last)
            #expect(reading.status != .tracking)
            #expect(reading.heading == nil || reading.heading?.trueHeadingDeg != nil, "the frame stays")
            return reading.fieldSigmaUt ?? 1e9
        }
        let sigmas = try [60, 3600, 86_400, nil].map(sigmaUt)
        #expect(sigmas == sigmas.sorted() && sigmas[0] < 10 && sigmas[3] > 2 * sigmas[0], "\(sigmas)")
    }

    @Test func aTextThatIsDamagedOrNewerIsATypedErrorAndChangesNothing() throws {
        let compensator = try Compensator()
        _ = try compensator.pushAll(events)
        let text = try #require(try compensator.keep(unixTimeS: nowS))
        for damaged in ["", "{}", "nonsense", String(text.dropLast(9))] {
            do {
                try compensator.adoptKept(damaged, unixTimeS: nowS)
                Issue.record("\(damaged) was taken")
            } catch MagcompError.keptDamaged(let why) {
                #expect(!why.isEmpty)
            }
        }
        #expect(throws: MagcompError.keptNewer(found: 99)) {
            try compensator.adoptKept(newer(text), unixTimeS: nowS)
        }
        #expect(try compensator.keep(unixTimeS: nowS) == text)
    }

    @Test func timeThatTheClockDoesNotShowMakesTheCalibrationLessSure() throws {
        func sigmaUt(hiddenS: Double) throws -> Double {
            let compensator = try Compensator()
            _ = try compensator.pushAll(events)
            let gaps = try compensator.gaps()
            try compensator.pushGap(hiddenS: hiddenS)
            #expect(try compensator.gaps() == gaps + 1)
            return try compensator.pushAll(flat(600)).last?.fieldSigmaUt ?? 1e9
        }
        #expect(try sigmaUt(hiddenS: 8 * 3600) > 1.2 * sigmaUt(hiddenS: 0))
        let compensator = try Compensator()
        #expect(throws: MagcompError.self) { try compensator.pushGap(hiddenS: -1) }
        #expect(try compensator.gaps() == 0)
    }

    @Test func aSaturatedSampleNamesItsAxis() throws {
        let compensator = try Compensator(config: CompensationConfig(railUt: 1200))
        let at: [(DeviceVector, DeviceVector.Axis, Double)] = [
            (DeviceVector(x: 1200, y: 1, z: 2), .x, 1200), (DeviceVector(x: 1, y: -1201, z: 2), .y, -1201),
            (DeviceVector(x: 1, y: 2, z: 1300), .z, 1300),
        ]
        for (k, (field, axis, valueUt)) in at.enumerated() {
            let status = try compensator.push(SensorSample.Magnetic(timeNs: Int64(k + 1), fieldUt: field)).status
            #expect(status == .rejected(reason: .saturated(axis: axis, valueUt: valueUt, railUt: 1200)))
        }
    }

    @Test func theHeadingFrameMayChangeInMidStream() throws {
        // at last it lies flat: a turned screen is a turned heading
        let events = events + flat(600)
        let compensator = try Compensator()
        let still = try compensator.pushAll(events).last?.heading
        let turned = try Compensator()
        try turned.setHeadingFrame(HeadingFrame(axis: .topEdge, screenRotation: .deg90, declinationDeg: 3))
        let after = try #require(try turned.pushAll(events).last?.heading)
        let before = try #require(still)
        #expect(abs((after.headingDeg - before.headingDeg - 90).remainder(dividingBy: 360)) < 1e-9)
        #expect(after.trueHeadingDeg == CompassHeading.trueHeadingDeg(headingDeg: after.headingDeg, declinationDeg: 3))
        #expect(throws: MagcompError.self) {
            try turned.setHeadingFrame(HeadingFrame(axis: .auto, screenRotation: .deg0, declinationDeg: 200))
        }
    }

    @Test func theEarthsFieldAtAPlace() throws {
        let midyear2025 = Date(timeIntervalSince1970: 1_750_000_000)
        let paris = try EarthMagneticField(latitudeDeg: 48.86, longitudeDeg: 2.35, heightM: 35, date: midyear2025)
        #expect((63...65).contains(paris.inclinationDeg) && (47...50).contains(paris.totalFieldUt))
        #expect(throws: MagcompError.self) {
            try EarthMagneticField(latitudeDeg: 91, longitudeDeg: 0, date: midyear2025)
        }
    }
}
