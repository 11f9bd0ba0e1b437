@testable import Magcomp
import Testing

/// The queue by the vectors that the core is held to, too.
@Suite struct EventQueueTests {
    struct Vectors: Decodable {
        struct Case: Decodable {
            let name: String
            let holdS: Double
            let deliveries: [[Int64]]
            let released: [[Int]]
        }
        let cases: [Case]
    }

    /// An event that carries its number.
    func event(_ kind: Int64, _ timeNs: Int64, _ number: Int) -> SensorSample {
        let value = DeviceVector(x: Double(number), y: 0, z: 0)
        return switch kind {
        case 0: .rotationRate(SensorSample.RotationRate(timeNs: timeNs, rateRadS: value))
        case 1: .up(SensorSample.Up(timeNs: timeNs, upMS2: value))
        default: .magnetic(SensorSample.Magnetic(timeNs: timeNs, fieldUt: value))
        }
    }

    func number(_ event: SensorSample) -> Int {
        switch event {
        case .rotationRate(let sample): Int(sample.rateRadS.x)
        case .up(let sample): Int(sample.upMS2.x)
        case .magnetic(let sample): Int(sample.fieldUt.x)
        case .systemField, .heading, .attitude, .note: -1
        }
    }

    @Test func deliveriesOfTheReference() throws {
        let cases = try vectors("event_order.json", as: Vectors.self).cases
        #expect(cases.count >= 20)
        for fact in cases {
            var queue = EventQueue(holdS: fact.holdS)
            var released = fact.deliveries.enumerated().map { number, delivery in
                queue.push([event(delivery[0], delivery[1], number)]).map(self.number)
            }
            released.append(queue.flush().map(number))
            #expect(released == fact.released, "\(fact.name)")
        }
    }

    @Test func timesOfAnySizeAreOrdered() {
        var queue = EventQueue(holdS: 0.05)
        let times: [Int64] = [.min, .max, 0, .max, .min, -1, 1]
        var out: [SensorSample] = []
        for (number, time) in times.enumerated() { out += queue.push([event(2, time, number)]) }
        out += queue.flush()
        #expect(out.map(number).sorted() == Array(times.indices), "none is lost")
    }

    @Test func theSystemsFieldIsBeforeTheSampleOfItsTimeAndNobodyWaitsForIt() {
        var queue = EventQueue(holdS: 0.05)
        let system = SensorSample.systemField(
            SensorSample.SystemField(timeNs: 7, fieldUt: DeviceVector(x: 0, y: 0, z: 0), accuracy: .low))
        var out = queue.push([event(2, 7, 1)])
        #expect(out == [])
        out += queue.push([system])
        out += queue.push([event(0, 7, 2)])
        #expect(out == [])
        out += queue.push([event(1, 7, 3)])
        #expect(out.map(number) == [2, -1, 3, 1])
        // without it nothing changes
        var later = queue.push([event(0, 9, 4)])
        later += queue.push([event(1, 9, 5)])
        later += queue.push([event(2, 9, 6)])
        #expect(later.map(number) == [4, 5, 6])
    }
}
