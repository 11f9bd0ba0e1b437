#if canImport(CoreMotion) && !os(macOS)
import CoreMotion
import Foundation
@_spi(Research) @testable import Magcomp
import Testing

/// Device motion that is delivered later than the magnetometer, on two recordings; prints the table of errors.
@Suite(.serialized, .longest) struct LagTests {
    /// A recording's rows as Core Motion has them, and the reference orientation, device to world, where it was seen.
    struct Recording {
        var rows: [CMMotionManager.Row] = []
        var orientations: [(w: Double, x: Double, y: Double, z: Double)?] = []

        init(_ name: String) throws {
            let text = try String(contentsOf: prepared(name), encoding: .utf8)
            for line in text.split(separator: "\n").dropFirst() {
                let v = line.split(separator: ",").map { Double($0)! }
                rows.append(
                    CMMotionManager.Row(
                        timestamp: v[0], field: (v[1], v[2], v[3]),
                        gravity: (-v[4] / 9.80665, -v[5] / 9.80665, -v[6] / 9.80665), rate: (v[7], v[8], v[9])))
                orientations.append(v[10].isNaN ? nil : (v[10], v[11], v[12], v[13]))
            }
        }

        /// The readings when device motion comes so much later.
        func readings(lagS: Double, holdS: Double) async throws -> (readings: [MagneticReading], seenS: Double?) {
            let manager = CMMotionManager()
            let source = CoreMotionSource(options: CoreMotionSource.Options(holdS: holdS), scripted: manager)
            var iterator = source.samples().compensated(capacity: rows.count).makeAsyncIterator()
            iterator.start()
            try await eventually { manager.isMagnetometerActive }
            manager.play(rows, motionLateS: lagS)
            // the end: what waits goes out before the error
            manager.magnetometerFails(CMErrorUnknown.error)
            var readings: [MagneticReading] = []
            do {
                while let reading = try await iterator.next() { readings.append(reading.reading) }
            } catch CompassError.refused {}
            return (readings, source.lagS)
        }

        /// Rms error of the heading, degrees: the field that carries it, turned to the world by the reference, should point
        /// along one direction. Without the first 20 s.
        func errorDeg(_ readings: [MagneticReading]) -> Double {
            var directions: [Double] = []
            for (reading, orientation) in zip(readings, orientations) where reading.timeNs >= 20_000_000_000 {
                guard let q = orientation, reading.heading != nil,
                    let h = reading.filteredFieldUt ?? reading.fieldUt
                else { continue }
                // v + 2 w (u x v) + 2 u x (u x v)
                let u = DeviceVector(x: q.x, y: q.y, z: q.z)
                let once = cross(u, h)
                let twice = cross(u, once)
                let east: Double = h.x + 2 * (q.w * once.x + twice.x)
                let north: Double = h.y + 2 * (q.w * once.y + twice.y)
                directions.append(atan2(east, north))
            }
            var (s, c, sum) = (0.0, 0.0, 0.0)
            for direction in directions {
                s += sin(direction)
                c += cos(direction)
            }
            let mean = atan2(s, c)
            for direction in directions {
                let error: Double = (direction - mean).remainder(dividingBy: 2 * Double.pi)
                sum += error * error
            }
            return (sum / Double(directions.count)).squareRoot() * 180 / Double.pi
        }

        func cross(_ a: DeviceVector, _ b: DeviceVector) -> DeviceVector {
            let x: Double = a.y * b.z - a.z * b.y
            let y: Double = a.z * b.x - a.x * b.z
            let z: Double = a.x * b.y - a.y * b.x
            return DeviceVector(x: x, y: y, z: z)
        }
    }

    @Test(arguments: ["recording.csv", "slow_rotation.csv"])
    func lateMotionGivesTheReadingsOfMotionInTime(name: String) async throws {
        let recording = try Recording(name)
        // what 1, 2 and 3 rows take, 57 a second
        let rowS = 0.0175
        let lags: [(lagS: Double, holdS: Double)] = [
            (0, 0.05), (0.01, 0.05), (0.02, 0.05), (0.035, 0.05), (0.05, 0.05), (-0.02, 0.05), (rowS, 0.05),
            (2 * rowS, 0.05), (3 * rowS, 0.06),
        ]
        let inTime = try await recording.readings(lagS: 0, holdS: 0).readings
        #expect(inTime.count == recording.rows.count)
        let bestDeg = recording.errorDeg(inTime)
        print("\(name): heading error, degrees rms, by how late device motion is")
        var worstDeg = 0.0
        for (lagS, holdS) in lags {
            let (readings, seenS) = try await recording.readings(lagS: lagS, holdS: holdS)
            let unordered = try await recording.readings(lagS: lagS, holdS: 0).readings
            let (beforeDeg, afterDeg) = (recording.errorDeg(unordered), recording.errorDeg(readings))
            worstDeg = max(worstDeg, beforeDeg)
            print(String(format: "  %6.1f ms: %6.2f as delivered, %6.2f by time", lagS * 1000, beforeDeg, afterDeg))
            // not in the macro, which would print both
            let isSame = readings == inTime
            #expect(isSame, "\(lagS) s late")
            // it is seen to about a row
            #expect(abs(try #require(seenS) - lagS) <= 0.02, "\(String(describing: seenS)) for \(lagS)")
        }
        #expect(worstDeg > 1.1 * bestDeg, "the order matters: \(worstDeg), in time \(bestDeg)")
    }
}
#endif
