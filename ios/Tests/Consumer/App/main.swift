import Foundation
import Magcomp
import Other

// Prints a recording's readings as `magcomp-ffi`'s example `expected` does, every number by its bits: field, total field, heading, its
// sigma, inclination.

let others: [Any.Type] = [
    Method.self, Attitude.self, Axis.self, Calibration.self, Other.Compass.self, Config.self, Coverage.self, Event.self,
    EventKind.self,
    Fit.self, GeomagneticField.self, Heading.self, LogLevel.self, Missing.self, Normalisation.self, Reading.self,
    Residual.self, Status.self, Termination.self, Vector3.self, Yaw.self,
    FfiConverterTypeMagneticReading.self,
    (any ConstantFieldProtocol).self,
]
let functions = [attitude as Any, correct as Any, heading as Any]

func bits(_ values: Double?...) -> String {
    values.map { $0.map { String($0.bitPattern, radix: 16) } ?? "-" }.joined(separator: " ")
}

func follow() async throws {
    let compass = Magcomp.Compass(source: RecordingSource(url: URL(fileURLWithPath: CommandLine.arguments[1])))
    for try await answer in compass.readings() {
        let reading = answer.reading
        let (field, heading) = (reading.fieldUt, reading.heading)
        let numbers = bits(
            field?.x, field?.y, field?.z, reading.totalFieldUt, heading?.headingDeg, heading?.headingSigmaDeg,
            heading?.inclinationDeg)
        print("reading \(reading.timeNs) \(reading.status.label) \(numbers)")
        if answer.droppedBefore > 0 { fatalError("\(answer.droppedBefore) readings were lost") }
    }
}

try await follow()
