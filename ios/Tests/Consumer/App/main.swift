import Foundation
import Magcomp
import Other

// Prints a recording's readings with the digits of `magcomp replay --axis auto`: corrected field, the estimator's own field,
// heading, its sigma, inclination, status.

let others: [Any.Type] = [
    Method.self, Attitude.self, Axis.self, Calibration.self, Config.self, Coverage.self, Event.self, EventKind.self,
    Fit.self, GeomagneticField.self, Heading.self, LogLevel.self, Missing.self, Normalisation.self, Reading.self,
    Residual.self, Status.self, Termination.self, Vector3.self, Yaw.self,
    FfiConverterTypeMagneticReading.self,
    (any ConstantFieldProtocol).self,
]
let functions = [attitude as Any, correct as Any, heading as Any]

func cells(_ values: [Double?], _ digits: Int) -> [String] {
    values.map { $0.map { String(format: "%.\(digits)f", $0) } ?? "" }
}

func follow() async throws {
    let compass = Compass(source: RecordingSource(url: URL(fileURLWithPath: CommandLine.arguments[1])))
    for try await answer in compass.readings() {
        let reading = answer.reading
        let fields = [reading.fieldUt, reading.filteredFieldUt].flatMap { [$0?.x, $0?.y, $0?.z] }
        let angles = [reading.heading?.headingDeg, reading.heading?.headingSigmaDeg, reading.heading?.inclinationDeg]
        print((cells(fields, 6) + cells(angles, 4) + [reading.status.label]).joined(separator: ","))
        if answer.droppedBefore > 0 { fatalError("\(answer.droppedBefore) readings were lost") }
    }
}

try await follow()
