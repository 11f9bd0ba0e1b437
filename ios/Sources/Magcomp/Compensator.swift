import MagcompFFI

/// Frees a magnetometer from the disturbance its phone carries, sample by sample.
///
/// Any thread may call it, and close it meanwhile: a call after ``close()`` throws `MagcompError.closed`. After a defect of
/// the library calls throw `MagcompError.panicked` until ``reset()``.
public final class Compensator: Sendable {
    /// The config it was made with. A field left out has the library's default, as in ``Compass`` (`CompensationConfig.defaults` shows all).
    public let config: CompensationConfig
    private let native: NativeCompensator
    // a number, not a pointer: that of a closed object finds nothing
    private let handle: Int64

    /// - Throws: `MagcompError.config` when a field of the config is out of range, `MagcompError.calibration` when
    ///   `CompensationConfig.initial` is no calibration
    public init(config: CompensationConfig = CompensationConfig()) throws {
        self.config = config
        native = try NativeCompensator(config: config)
        handle = native.fastHandle()
    }

    /// A raw magnetometer event and its answer. A sample that cannot be used comes back with status `.rejected` and
    /// changes nothing. After 50 such samples in a row whose times follow one another but not the latest used sample,
    /// the compensator assumes another clock: it keeps the calibration and begins anew with everything else. At the
    /// sensor's full scale (`.saturated`) a gyroscope carries the field on: the reading has a carried field and a heading,
    /// and nothing is learned.
    public func push(_ sample: SensorSample.Magnetic) throws -> MagneticReading {
        let (field, reported) = (sample.fieldUt, sample.reportedHardIronUt)
        let unknown = Double.nan
        var out = MagcompReading()
        let code = magcomp_push(
            handle, sample.timeNs, field.x, field.y, field.z,
            reported?.x ?? unknown, reported?.y ?? unknown, reported?.z ?? unknown, &out)
        try check(code)
        return MagneticReading(out, timeNs: sample.timeNs)
    }

    /// A gyroscope event.
    ///
    /// - Returns: whether it was used; if not, for instance because it came too late, nothing has changed
    @discardableResult
    public func pushRotationRate(_ sample: SensorSample.RotationRate) throws -> Bool {
        let rate = sample.rateRadS
        return try check(magcomp_push_rotation_rate(handle, sample.timeNs, rate.x, rate.y, rate.z)) == 0
    }

    /// An accelerometer or gravity event; at rest it points up.
    ///
    /// - Returns: whether it was used; if not, for instance because it came too late, nothing has changed
    @discardableResult
    public func pushUp(_ sample: SensorSample.Up) throws -> Bool {
        let up = sample.upMS2
        return try check(magcomp_push_up(handle, sample.timeNs, up.x, up.y, up.z)) == 0
    }

    /// Any event; the answer to a magnetic one. A heading or an attitude whose time is not right is passed over, and so is a note: that
    /// is a ``Compass``'s.
    ///
    /// - Throws: `MagcompError.eventRejected` for a heading or an attitude whose numbers can't be
    public func push(_ event: SensorSample) throws -> MagneticReading? {
        switch event {
        case .magnetic(let sample): return try push(sample)
        case .rotationRate(let sample): try pushRotationRate(sample)
        case .up(let sample): try pushUp(sample)
        case .systemField, .note: break
        case .heading, .attitude: _ = try take(event)
        }
        return nil
    }

    /// Whether help from outside was taken; false where its time was not right.
    func take(_ help: SensorSample) throws -> Bool {
        do {
            if case .heading(let sample) = help { try pushHeading(sample) }
            if case .attitude(let sample) = help { try pushAttitude(sample) }
            return true
        } catch MagcompError.eventRejected(let reason) where reason != .notFinite && reason != .outOfRange {
            return false
        }
    }

    /// A heading from outside: a GNSS course, a landmark. It is used at the magnetometer sample that follows it in time, or comes up to 5 s
    /// late. Headings go by it, the calibration does not.
    ///
    /// - Throws: `MagcompError.eventRejected`, which says why it was not taken; nothing has changed then
    public func pushHeading(_ sample: SensorSample.Heading) throws { try native.pushHeading(sample: sample) }

    /// An orientation from outside: a camera's pose. While the gyroscope is missing its turns stand in for it; one whose yaw is known is a
    /// heading too.
    ///
    /// - Throws: `MagcompError.eventRejected`, which says why it was not taken; nothing has changed then
    public func pushAttitude(_ sample: SensorSample.Attitude) throws { try native.pushAttitude(sample: sample) }

    /// What headings from outside are worth after the latest sample; nil where none came in the last two minutes.
    public func headingAid() throws -> CompensatedReading.HeadingAid? { try native.headingAid() }

    /// The declination that true headings from outside have shown; nil before the first, and while a declination is set.
    public func foundDeclination() throws -> Compass.FoundDeclination? { try native.foundDeclination() }

    /// From now on headings are those of this frame, for instance when the screen was turned. Nothing else changes.
    ///
    /// - Throws: `MagcompError.config` when the declination is out of range
    public func setHeadingFrame(_ frame: HeadingFrame) throws { try native.setHeadingFrame(frame: frame) }

    /// Hard iron, soft iron and field strength in force, if any.
    public func calibration() throws -> MagnetometerCalibration? { try native.calibration() }

    /// From now on this calibration is in force, until something better is learned. The stream goes on.
    ///
    /// - Parameters:
    ///   - calibration: hard iron, soft iron and field strength
    ///   - hardIronSigmaUt: one standard deviation of each component of its hard iron, microtesla, 0.01 to 1000; the first
    ///     readings are as unsure as that
    /// - Throws: `MagcompError.calibration` when the numbers are no calibration, `MagcompError.config` when the
    ///   standard deviation is out of range; nothing has changed then
    public func adopt(_ calibration: MagnetometerCalibration, hardIronSigmaUt: Double) throws {
        try native.adopt(calibration: calibration, hardIronSigmaUt: hardIronSigmaUt)
    }

    /// The calibration in force with what is known of it, as JSON, for ``adoptKept(_:unixTimeS:)`` at the next launch. Nil while
    /// nothing was learned from live samples: what was adopted is kept where it came from.
    ///
    /// - Parameter unixTimeS: now, seconds since 1970
    public func keep(unixTimeS: Int64) throws -> String? { try native.keep(unixTimeS: unixTimeS) }

    /// From now on the calibration of a text of ``keep(unixTimeS:)`` is in force, until something better is learned. The stream, the
    /// config and the heading frame stay. It is as sure as it was, less what its age costs; the first live samples are judged
    /// by: what disagrees widens or replaces it.
    ///
    /// - Parameters:
    ///   - text: what was kept
    ///   - unixTimeS: now, seconds since 1970, by the clock that ``keep(unixTimeS:)`` was told; nil: not known, so as good as
    ///     nothing is believed beforehand
    /// - Throws: `MagcompError.keptDamaged` or `MagcompError.keptNewer`; nothing has changed then
    public func adoptKept(_ text: String, unixTimeS: Int64?) throws {
        try native.adoptKept(text: text, unixTimeS: unixTimeS)
    }

    /// Time passed that the clock of the samples does not show: the phone slept. The calibration is as unsure from here on as one
    /// that was kept for so long, and where the field points is found anew. The samples' time goes on.
    ///
    /// - Parameter hiddenS: about how long, seconds, 0 to 1e9
    /// - Throws: `MagcompError.config` when that is out of range; nothing has changed then
    public func pushGap(hiddenS: Double) throws { try native.pushGap(hiddenS: hiddenS) }

    /// Gaps so far: of the gyroscope while it was in use, of samples, and those told by ``pushGap(hiddenS:)``.
    public func gaps() throws -> Int64 { try native.gaps() }

    /// Covariance of b_x b_y b_z (microtesla) m_xx m_yy m_zz m_xy m_xz m_yz (dimensionless) in force, 9 x 9, row by row;
    /// nil when it is not known.
    @_spi(Research) public func covariance() throws -> [Double]? { try native.covariance() }

    /// The latest ellipsoid fit that was accepted, with its covariance; the aided and the adaptive method make none.
    @_spi(Research) public func fit() throws -> EllipsoidFit? { try native.fit() }

    /// Where the field has not pointed yet, unit vectors in the device frame, for guidance; ``MagneticReading/coverage`` is the share that
    /// was seen.
    public func unseenDirections() throws -> [DeviceVector] {
        var numbers = [Double](repeating: 0, count: Int(MAGCOMP_DIRECTIONS) * 3)
        let count = Int(try check(magcomp_unseen_directions(handle, &numbers)))
        return (0..<count).map { DeviceVector(x: numbers[3 * $0], y: numbers[3 * $0 + 1], z: numbers[3 * $0 + 2]) }
    }

    /// Forgets everything but the config it was made with, also a heading frame that was set since. Makes the
    /// compensator usable again after `MagcompError.panicked`.
    public func reset() throws { try native.reset() }

    /// Frees the native state now. May be called twice, and while another thread pushes.
    public func close() { native.close() }

    @discardableResult
    private func check(_ code: Int32) throws -> Int32 {
        if code >= 0 { return code }
        if code == Int32(MAGCOMP_PANICKED) {
            // the error with what the panic said; when another thread has reset it meanwhile, this call goes through
            _ = try native.calibration()
            throw MagcompError.panicked(what: "reset meanwhile")
        }
        throw MagcompError.closed
    }

    /// For tests alone.
    var fastHandle: Int64 { handle }
}
