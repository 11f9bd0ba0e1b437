import Foundation
@_spi(Research) import Magcomp
import Testing

@Suite struct CalibrationJSONTests {
    let json: Data

    init() throws { json = try Data(contentsOf: repository.appendingPathComponent("tests/vectors/calibration.json")) }

    /// The numbers stand in Rust's and Kotlin's tests of the same file too.
    @Test func theCommandsFileIsRead() throws {
        let calibration = try MagnetometerCalibration(json: json)
        #expect(
            calibration.softIron
                == SoftIron(
                    xx: 1.0074739066651197, yy: 0.9949408198854466, zz: 0.9975852116805589,
                    xy: 0.0010278183785302803, xz: 0.0033559853288960234, yz: -0.0005891320979764632))
        #expect(
            calibration.hardIronUt
                == DeviceVector(x: 0.4434981867517305, y: 0.07810767384555047, z: -0.2777318011715177))
        #expect(calibration.fieldStrengthUt == 44.62375335464398)
        var config = CompensationConfig.defaults
        config.initial = calibration
        #expect(try Compensator(config: config).calibration() == calibration)
    }

    @Test func whatIsNoCalibrationIsRefusedAndSaysWhy() throws {
        func changed(_ name: String, _ value: Any) throws -> Data {
            var object = try #require(try JSONSerialization.jsonObject(with: json) as? [String: Any])
            object[name] = value
            return try JSONSerialization.data(withJSONObject: object)
        }
        let cases = [
            (Data(), "no calibration of magcomp replay"),
            (Data("[1, 2]".utf8), "no calibration of magcomp replay"),
            (try changed("hard_iron_ut", [1.0, 2.0]), "hard_iron_ut has 2 numbers, not 3"),
            (try changed("field_strength_ut", "strong"), "fieldStrengthUt"),
            (try changed("soft_iron", [1, 2, 3, 4, 5, 6, 7, 8, 9]), "soft_iron is not symmetric"),
            (try changed("soft_iron", [-1, 0, 0, 0, 1, 0, 0, 0, 1]), "positive definite"),
        ]
        for (data, why) in cases {
            do {
                let calibration = try MagnetometerCalibration(json: data)
                Issue.record("\(calibration) was taken, expected '\(why)'")
            } catch let error as MagcompError {
                #expect(error.text.contains(why), "\(error.text) lacks '\(why)'")
            }
        }
    }
}
