import Foundation

/// The answer to one magnetometer sample, as iterators get it.
public struct CompensatedReading: Equatable, Codable, Sendable {
    /// Corrected field, heading, and what the compensator is doing.
    public var reading: MagneticReading
    /// The raw sample it answers.
    public var sample: SensorSample.Magnetic
    /// The operating system's own calibrated field, the latest before it, where the source delivers that.
    public var systemField: SensorSample.SystemField?
    /// Where the field has not pointed yet, unit vectors in the device frame: an app may ask for the phone to be turned so
    /// that it does. Renewed several times a second.
    public var unseenDirections: [DeviceVector]
    /// `MagcompError.keptDamaged` or `MagcompError.keptNewer` for the text that the calibration store gave, until something was
    /// learned and saved; else nil.
    public var storeError: MagcompError?
    /// What help from outside is worth now (`Compass.aid`); nil where none came in the last two minutes.
    public var headingAid: CompensatedReading.HeadingAid?
    /// Readings dropped right before this one because the iterator was slow; the estimator saw every sample all the same.
    public var droppedBefore: Int
    /// When its sample was taken, to be laid beside a `CLLocation` or a `CLHeading`, by the device's clock as it was when the sample came.
    /// Nil for a source whose times are not those of the device's sensors: a recording, a simulation.
    public var timestamp: Date?
    /// Whether the source has delivered no sample for 2 s: there is neither field nor heading nor attitude then. It is told once, and
    /// the next reading comes with the next sample; ``sample`` is the last one, all zeros where there was none.
    public var isSilent = false

    /// For previews and tests: an app gets its readings by iterating.
    public init(
        reading: MagneticReading, sample: SensorSample.Magnetic, systemField: SensorSample.SystemField? = nil,
        unseenDirections: [DeviceVector] = [], storeError: MagcompError? = nil,
        headingAid: CompensatedReading.HeadingAid? = nil,
        droppedBefore: Int = 0, timestamp: Date? = nil
    ) {
        (self.reading, self.sample, self.systemField) = (reading, sample, systemField)
        (self.unseenDirections, self.storeError, self.droppedBefore) = (unseenDirections, storeError, droppedBefore)
        (self.headingAid, self.timestamp) = (headingAid, timestamp)
    }

    /// Of no sample: the source is silent.
    init(silentAfter sample: SensorSample.Magnetic?, storeError: MagcompError? = nil, unseenDirections: [DeviceVector] = [])
    {
        let latest = sample ?? SensorSample.Magnetic(timeNs: 0, fieldUt: DeviceVector(x: 0, y: 0, z: 0))
        self.init(
            reading: MagneticReading(
                timeNs: latest.timeNs, status: .collecting(missing: .samples(have: 0, need: 1))),
            sample: latest, unseenDirections: unseenDirections, storeError: storeError)
        isSilent = true
    }

    /// Clockwise from magnetic north, degrees, 0 to 360; nil when it is not known.
    public var headingDeg: Double? { reading.headingDeg }
    /// One standard deviation of it, degrees.
    public var headingSigmaDeg: Double? { reading.headingSigmaDeg }
    /// Clockwise from true north, degrees, 0 to 360; nil without a heading or a declination (``Compass/setPlace(_:)``).
    public var trueHeadingDeg: Double? { reading.trueHeadingDeg }
    /// What the compass is doing, and why.
    public var status: CompensationStatus { reading.status }
    /// How the phone is turned; nil when it is not known.
    public var attitude: DeviceAttitude? { reading.attitude }
    /// One sentence an app may show, in the app's language: what the compass is doing, or that the sensors deliver nothing.
    public var localizedText: String { isSilent ? say("ios_silent") : status.localizedText }
    /// What the person can do for a better heading, in the app's language; nil: nothing.
    public var localizedGuidance: String? { isSilent ? nil : status.localizedGuidance }

    /// Core Motion counts its times from the start of the device, without its sleep.
    static func date(
        of sample: SensorSample.Magnetic, now: Date = Date(), uptimeNs: Int64 = SystemClock().nowNs
    ) -> Date {
        now.addingTimeInterval((Double(sample.timeNs) - Double(uptimeNs)) * 1e-9)
    }
}

extension MagneticReading {
    /// For previews and tests. A value that is not given is unknown.
    ///
    /// - Parameters:
    ///   - timeNs: time of the sample, nanoseconds
    ///   - status: what the compensator is doing
    ///   - heading: heading and inclination
    ///   - attitude: how the device lies
    ///   - fieldUt: the corrected field, microtesla, device frame
    ///   - coverage: share of the directions seen, 0 to 1
    ///   - event: the latest decided change
    public init(
        timeNs: Int64 = 0, status: CompensationStatus, heading: CompassHeading? = nil, attitude: DeviceAttitude? = nil,
        fieldUt: DeviceVector? = nil, coverage: Double = 0, event: FieldEvent? = nil
    ) {
        let length = fieldUt.map { ($0.x * $0.x + $0.y * $0.y + $0.z * $0.z).squareRoot() }
        self.init(
            timeNs: timeNs, fieldUt: fieldUt, fieldSigmaUt: nil, filteredFieldUt: nil, totalFieldUt: length,
            heading: heading, attitude: attitude, sigmaT: nil, window: 0, coverage: coverage, directionSigmaDeg: nil,
            worstSigmaDeg: nil,
            modelOrder: nil, reportedHardIronJumpUt: nil, mode: .gyroscopeAndGravity, event: event, status: status)
    }
}
