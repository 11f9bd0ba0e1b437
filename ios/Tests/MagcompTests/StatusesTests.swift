import Foundation
@_spi(Research) @testable import Magcomp
import MagcompFFI
import Testing

/// Every status, reason, event and heading aid against `tests/vectors/statuses.json`, where they stand by hand for all
/// languages.
struct StatusesTests {
    struct Known: Decodable {
        struct Status: Decodable {
            let status, label, en: String
            let border: [Int32]
            let whole: [Int64]?
            let real: [Double]?
            let guidance: String?
        }

        struct Event: Decodable {
            let kind, en: String
            let border: Int32
            let sinceNs, decidedNs: Int64
        }

        struct Aid: Decodable {
            let name, en: String
        }

        let statuses: [Status]
        let events: [Event]
        let headingAids: [Aid]
    }

    let known: Known

    init() throws { known = try vectors("statuses.json") }

    /// As the border writes it, with other numbers where there are any; axes stay.
    func read(
        _ of: Known.Status, whole: (Int64) -> Int64 = { $0 }, real: (Double) -> Double = { $0 }
    ) -> CompensationStatus {
        let hasAxis = of.status.contains(#/\b(axis|x): /#)
        let wholes = (of.whole ?? []).map { hasAxis ? $0 : whole($0) } + [0, 0]
        let reals = (of.real ?? []).map { hasAxis ? $0 : real($0) } + [.nan, .nan, .nan]
        return CompensationStatus(
            MagcompStatus(
                kind: of.border[0], reason: of.border[1], problem: of.border[2], whole: (wholes[0], wholes[1]),
                real: (reals[0], reals[1], reals[2])))
    }

    /// A status as the file has it, in Swift's spelling.
    func swift(_ status: String) -> String {
        status.replacing(#/_([a-z])/#) { $0.1.uppercased() }.replacing(#/\b[A-Z]/#) { $0.0.lowercased() }
    }

    @Test func aStatusIsReadFromCAndSaidAsTheCoreSaysIt() {
        for fact in known.statuses {
            let status = read(fact)
            let described = String(describing: status)
                .replacing(#/Magcomp\.([A-Z]\w*\.)+|(missing|reason|problem): /#, with: "")
            #expect(described == swift(fact.status))
            #expect(status.label == fact.label)
            #expect(status.text == fact.en)
            #expect(status.localizedText == fact.en)
            #expect(status.localizedGuidance == fact.guidance)
        }
    }

    /// The cases of an enum of the library, as its source has them.
    func cases(_ of: String) throws -> [String] {
        let file = repository.appendingPathComponent("bindings/swift/Magcomp.swift")
        let source = try String(contentsOf: file, encoding: .utf8)
        let body = source.components(separatedBy: "public enum \(of): ").last?.components(separatedBy: "\n#if ").first ?? ""
        return body.matches(of: #/\n +case (\w+)/#).map { String($0.1) }
    }

    @Test func theFileHasEveryCaseOfTheLibrary() throws {
        for (of, within) in [
            ("CompensationStatus", ""), ("CollectingReason", "collecting("), ("FitProblem", "collecting(fit("),
            ("HoldReason", "held("), ("RejectReason", "rejected("),
        ] {
            let ours = known.statuses.map { swift($0.status) }.filter { $0.hasPrefix(within) }
            let names = ours.map { String($0.dropFirst(within.count).prefix(while: \.isLetter)) }
            #expect(try Set(names) == Set(cases(of)), "\(of)")
        }
        #expect(try known.events.map { swift($0.kind) } == cases("Kind"))
        #expect(try known.headingAids.map { swift($0.name) } == cases("HeadingAid"))
    }

    @Test func theTextsHaveTheCoresOwnNumbers() {
        for _ in 0..<200 {
            for fact in known.statuses {
                // never half way between two decimals
                let real: (Double) -> Double = { _ in .random(in: -3000...3000) }
                let status = read(fact, whole: { _ in .random(in: 0...10_000) }, real: real)
                #expect(status.localizedText == status.text)
            }
        }
    }

    @Test func anEventAndAHeadingAid() throws {
        for fact in known.events {
            var reading = MagcompReading()
            reading.event = MagcompEvent(kind: fact.border, since_ns: fact.sinceNs, decided_ns: fact.decidedNs)
            let event = try #require(MagneticReading(reading, timeNs: 1).event)
            #expect(String(describing: event.kind) == swift(fact.kind))
            #expect(event.localizedText == fact.en)
        }
        for (fact, aid) in zip(known.headingAids, [CompensatedReading.HeadingAid.used, .leads, .disagrees]) {
            #expect(String(describing: aid) == swift(fact.name))
            #expect([aid.text, aid.localizedText] == [fact.en, fact.en])
        }
    }
}
