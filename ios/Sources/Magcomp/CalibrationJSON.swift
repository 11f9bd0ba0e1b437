import Foundation

extension MagnetometerCalibration {
    /// Reads the calibration that the command `magcomp replay --calibration OUT.json` writes: `soft_iron`, the nine elements of
    /// the symmetric matrix M; `hard_iron_ut`, the three components of b, microtesla; `field_strength_ut`, microtesla. Other
    /// names in the file are passed over, the covariance too.
    ///
    /// The result can be `CompensationConfig.initial` or go to ``Compensator/adopt(_:hardIronSigmaUt:)``.
    ///
    /// - Parameter json: the content of the file
    /// - Throws: `MagcompError.calibration` when it is no such JSON, or the numbers are no calibration
    public init(json: Data) throws {
        struct Written: Decodable {
            let softIron, hardIronUt: [Double]
            let fieldStrengthUt: Double
        }
        func refused(_ why: String) -> MagcompError { .calibration(why: "no calibration of magcomp replay: \(why)") }
        let decoder = JSONDecoder()
        decoder.keyDecodingStrategy = .convertFromSnakeCase
        let read: Written
        do {
            read = try decoder.decode(Written.self, from: json)
        } catch {
            throw refused("\(error)")
        }
        let (m, b) = (read.softIron, read.hardIronUt)
        guard m.count == 9 else { throw refused("soft_iron has \(m.count) numbers, not 9") }
        guard b.count == 3 else { throw refused("hard_iron_ut has \(b.count) numbers, not 3") }
        guard m[1] == m[3], m[2] == m[6], m[5] == m[7] else { throw refused("soft_iron is not symmetric") }
        self.init(
            softIron: SoftIron(xx: m[0], yy: m[4], zz: m[8], xy: m[1], xz: m[2], yz: m[5]),
            hardIronUt: DeviceVector(x: b[0], y: b[1], z: b[2]), fieldStrengthUt: read.fieldStrengthUt)
        // the core refuses what is none
        _ = try correct(DeviceVector(x: 0, y: 0, z: 0))
    }
}
