// swift-format-ignore-file
// made by bindings/generate.sh from bindings/status.toml and bindings/reading.toml
import MagcompFFI

// Converts the answers of the C path to the records that uniffi makes; a test compares every one with what uniffi says.

extension MagneticReading {
    init(_ c: MagcompReading, timeNs: Int64) {
        let heading = known(c.heading_deg).map {
            CompassHeading(headingDeg: $0, headingSigmaDeg: known(c.heading_sigma_deg), trueHeadingDeg: known(c.true_heading_deg), inclinationDeg: known(c.inclination_deg))
        }
        let attitude = known(c.attitude_w).map {
            DeviceAttitude(w: $0, x: c.attitude_x, y: c.attitude_y, z: c.attitude_z, sigmaDeg: known(c.attitude_sigma_deg))
        }
        self.init(
            timeNs: timeNs,
            fieldUt: vector(c.field_ut),
            fieldSigmaUt: known(c.field_sigma_ut),
            filteredFieldUt: vector(c.filtered_field_ut),
            totalFieldUt: known(c.total_field_ut),
            heading: heading,
            attitude: attitude,
            sigmaT: known(c.sigma_t),
            window: Int(c.window),
            coverage: c.coverage,
            directionSigmaDeg: known(c.direction_sigma_deg),
            worstSigmaDeg: known(c.worst_sigma_deg),
            modelOrder: ModelOrder(c.model_order),
            reportedHardIronJumpUt: known(c.reported_hard_iron_jump_ut),
            mode: MagneticReading.SensorMode(c.mode),
            event: FieldEvent(c.event),
            status: CompensationStatus(c.status)
        )
    }
}

private func known(_ value: Double) -> Double? { value.isNaN ? nil : value }

private func vector(_ v: (Double, Double, Double)) -> DeviceVector? {
    v.0.isNaN ? nil : DeviceVector(x: v.0, y: v.1, z: v.2)
}

/// An axis as a number: 1 to 3, negative where it points the other way; 0 for what is none.
private func axis(_ number: Double) -> Int { Int(exactly: number) ?? 0 }

/// The header and the library are of one build: only a defect leads here.
private func unknown(_ what: String, _ code: Int32) -> Never {
    fatalError("\(what) \(code): the library's native part is of another version")
}

extension MagneticReading.SensorMode {
    fileprivate init(_ code: Int32) {
        self =
            switch code {
            case 0: .gyroscopeAndGravity
            case 1: .gyroscopeOnly
            case 2: .gravityOnly
            case 3: .magnetometerOnly
            default: unknown("mode", code)
            }
    }
}

extension ModelOrder {
    fileprivate init?(_ code: Int32) {
        switch code {
        case 0: self = .nothing
        case 1: self = .hardIron
        case 2: self = .all
        case 3: self = .former
        default: return nil
        }
    }
}

extension FieldEvent {
    fileprivate init?(_ c: MagcompEvent) {
        let kind: FieldEvent.Kind? =
            switch c.kind {
            case 0: .deviceStep
            case 1: .deviceStepBack
            case 2: .placeChanged
            default: nil
            }
        guard let kind else { return nil }
        self.init(kind: kind, sinceNs: c.since_ns, decidedNs: c.decided_ns)
    }
}

extension CompensationStatus {
    init(_ c: MagcompStatus) {
        self =
            switch c.kind {
            case 0: .collecting(missing: CompensationStatus.CollectingReason(c))
            case 1: .tracking
            case 2: .suspect(sinceNs: c.whole.0)
            case 3: .held(reason: CompensationStatus.HoldReason(c))
            case 4: .disturbed(sinceNs: c.whole.0)
            case 5: .rejected(reason: CompensationStatus.RejectReason(c))
            default: unknown("status", c.kind)
            }
    }
}

extension CompensationStatus.CollectingReason {
    fileprivate init(_ c: MagcompStatus) {
        self =
            switch c.reason {
            case 0: .samples(have: Int(clamping: c.whole.0), need: Int(clamping: c.whole.1))
            case 1: .fit(problem: CompensationStatus.FitProblem(c))
            case 2: .rotation
            case 3: .directions
            default: unknown("missing", c.reason)
            }
    }
}

extension CompensationStatus.HoldReason {
    fileprivate init(_ c: MagcompStatus) {
        self =
            switch c.reason {
            case 0: .lowUniformity
            case 1: .fitRefused(problem: CompensationStatus.FitProblem(c))
            case 2: .constant
            case 3: .atRest
            case 4: .tooLittleRotation
            case 5: .noGyroscope
            default: unknown("hold reason", c.reason)
            }
    }
}

extension CompensationStatus.RejectReason {
    fileprivate init(_ c: MagcompStatus) {
        self =
            switch c.reason {
            case 0: .notFinite
            case 1: .outOfRange(valueUt: c.real.0, limitUt: c.real.1)
            case 2: .saturated(axis: DeviceVector.Axis(c.whole.0), valueUt: c.real.0, railUt: c.real.1)
            case 3: .timeNotAfter(timeNs: c.whole.0, latestNs: c.whole.1)
            case 4: .timeJump(gapS: c.real.0, limitS: c.real.1)
            case 5: .stuck(repeats: Int(clamping: c.whole.0))
            case 6: .axes(x: axis(c.real.0), y: axis(c.real.1), z: axis(c.real.2))
            default: unknown("reject reason", c.reason)
            }
    }
}

extension CompensationStatus.FitProblem {
    fileprivate init(_ c: MagcompStatus) {
        self =
            switch c.problem {
            case 0: .tooFewSamples(have: Int(clamping: c.whole.0))
            case 1: .planar(thicknessUt: c.real.0)
            case 2: .poorCoverage(directionSigmaDeg: c.real.0, limitDeg: c.real.1)
            case 3: .inconsistent(residualUt: c.real.0, limitUt: c.real.1)
            case 4: .notAnEllipsoid
            case 5: .fieldOutOfRange(fieldUt: c.real.0, lowUt: c.real.1, highUt: c.real.2)
            case 6: .notFinite
            default: unknown("fit problem", c.problem)
            }
    }
}

extension DeviceVector.Axis {
    fileprivate init(_ number: Int64) {
        self =
            switch number {
            case 0: .x
            case 1: .y
            case 2: .z
            default: unknown("axis", Int32(truncatingIfNeeded: number))
            }
    }

    var name: String {
        switch self {
        case .x: "x"
        case .y: "y"
        case .z: "z"
        }
    }
}
