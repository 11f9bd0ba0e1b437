@testable import Magcomp
import Testing

/// The English texts, which come from `Localizable.strings`, are the core's own words.
struct TextsTests {
    struct Facts: Decodable {
        struct Event: Decodable {
            let kind, text: String
            let sinceNs, decidedNs: Int64
        }

        let events: [Event]
    }

    func statuses(_ random: inout SystemRandomNumberGenerator) -> [CompensationStatus] {
        // never half way between two decimals
        func real() -> Double { .random(in: -3000...3000, using: &random) }
        func whole() -> Int32 { .random(in: 0...10_000, using: &random) }
        let problems: [FitProblem] = [
            .tooFewSamples(have: whole()), .planar(thicknessUt: real()),
            .poorCoverage(directionSigmaDeg: real(), limitDeg: real()),
            .inconsistent(residualUt: real(), limitUt: real()), .notAnEllipsoid,
            .fieldOutOfRange(fieldUt: real(), lowUt: real(), highUt: real()), .notFinite,
        ]
        let held: [HoldReason] = [.lowUniformity, .constant, .atRest, .tooLittleRotation, .noGyroscope]
        let rejected: [RejectReason] = [
            .notFinite, .outOfRange(valueUt: real(), limitUt: real()),
            .saturated(axis: [.x, .y, .z].randomElement(using: &random)!, valueUt: real(), railUt: real()),
            .timeNotAfter(timeNs: .random(in: .min ... .max), latestNs: .random(in: .min ... .max)),
            .timeJump(gapS: real(), limitS: 604_800), .stuck(repeats: whole()),
        ]
        var all: [CompensationStatus] = [.tracking, .suspect(sinceNs: 1), .disturbed(sinceNs: 1)]
        all.append(.collecting(missing: .samples(have: whole(), need: whole())))
        all += [.collecting(missing: .rotation), .collecting(missing: .directions)]
        all += problems.flatMap { [.collecting(missing: .fit(problem: $0)), .held(reason: .fitRefused(problem: $0))] }
        all += held.map { .held(reason: $0) }
        return all + rejected.map { .rejected(reason: $0) }
    }

    @Test func statuses() {
        var random = SystemRandomNumberGenerator()
        for _ in 0..<200 {
            for status in statuses(&random) { #expect(status.localizedText == status.text) }
        }
    }

    @Test func events() throws {
        let facts: Facts = try vectors("facts.json")
        let kinds: [String: FieldEventKind] = [
            "DeviceStep": .deviceStep, "DeviceStepBack": .deviceStepBack, "PlaceChanged": .placeChanged,
        ]
        #expect(Set(facts.events.map(\.kind)) == Set(kinds.keys))
        for fact in facts.events {
            let event = FieldEvent(kind: try #require(kinds[fact.kind]), sinceNs: fact.sinceNs, decidedNs: fact.decidedNs)
            #expect(event.localizedText == fact.text)
        }
    }
}
