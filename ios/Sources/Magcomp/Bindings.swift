import Foundation

// The generated bindings' global functions are `package`, because they would stand in every app's namespace. Here they
// become members. `MagcompBindings.swift` is a link to them.

extension MagcompError: LocalizedError {
    /// The error in a sentence that says what to do.
    public var errorDescription: String? { text }
}

extension MagneticReading {
    /// Clockwise from magnetic north, degrees, 0 to 360; nil when it is not known.
    public var headingDeg: Double? { heading?.headingDeg }
    /// One standard deviation of it, degrees.
    public var headingSigmaDeg: Double? { heading?.headingSigmaDeg }
    /// Clockwise from true north, degrees, 0 to 360; nil without a heading or a declination.
    public var trueHeadingDeg: Double? { heading?.trueHeadingDeg }
}

extension DeviceVector {
    /// From the standard library's vector.
    public init(_ v: SIMD3<Double>) { self.init(x: v.x, y: v.y, z: v.z) }
}

extension SIMD3<Double> {
    /// To the standard library's vector, which computes.
    public init(_ v: DeviceVector) { self.init(v.x, v.y, v.z) }
}

#if canImport(simd)
import simd

extension simd_quatd {
    /// From device to east, magnetic north and up.
    public init(_ attitude: DeviceAttitude) { self.init(ix: attitude.x, iy: attitude.y, iz: attitude.z, r: attitude.w) }
}
#endif

extension CompensationConfig {
    /// What an app may know of its phone and place; a field left out has the library's default.
    public init(
        initial: MagnetometerCalibration? = nil, initialSigmaUt: Double? = nil, useReportedHardIron: Bool? = nil,
        rangeUt: Double? = nil, railUt: Double? = nil, fieldStrengthUt: Double? = nil
    ) {
        self.init(
            method: nil, initial: initial, initialSigmaUt: initialSigmaUt, useReportedHardIron: useReportedHardIron,
            rangeUt: rangeUt, railUt: railUt, fieldStrengthUt: fieldStrengthUt, heading: nil, windowed: nil)
    }

    /// The library's defaults, every field given.
    public static var defaults: CompensationConfig { defaultConfig() }
}

extension MagnetometerCalibration {
    /// The field a raw sample stands for, h = M^-1 (raw - b).
    ///
    /// - Parameter rawUt: the sample, microtesla, device frame
    /// - Returns: microtesla, device frame
    /// - Throws: `MagcompError.calibration` when the soft iron is not positive definite or a number is out of range
    public func correct(_ rawUt: DeviceVector) throws -> DeviceVector {
        try Magcomp.correct(calibration: self, rawUt: rawUt)
    }
}

extension Compensator.LogLevel {
    /// Writes messages of this level and above to standard error from now on, the place of a defect too. The first call in a
    /// process sets the tag, later ones the level.
    ///
    /// - Parameter tag: what every line begins with
    public func startLogging(tag: String) { Magcomp.startLogging(tag: tag, level: self) }
}
