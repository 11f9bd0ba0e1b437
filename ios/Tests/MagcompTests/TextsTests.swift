import Foundation
@testable import Magcomp
import Testing

/// The English texts, which come from `Localizable.strings`, are the core's own words.
struct TextsTests {
    /// An app may make or decode what the core never says.
    @Test(arguments: [0, 4, -4, .max, .min]) func numbersThatAreNoneHaveATextToo(number: Int) throws {
        let whole: [CompensationStatus] = [
            .rejected(reason: .axes(x: number, y: -1, z: 2)), .rejected(reason: .stuck(repeats: number)),
            .rejected(reason: .timeNotAfter(timeNs: Int64(number), latestNs: .min)),
            .collecting(missing: .samples(have: number, need: number)),
            .collecting(missing: .fit(problem: .tooFewSamples(have: number))),
        ]
        let real: [CompensationStatus] = [Double.nan, .infinity, -.infinity, 1e300, -0.0].flatMap {
            value -> [CompensationStatus] in
            let problems: [CompensationStatus.FitProblem] = [
                .planar(thicknessUt: value), .poorCoverage(directionSigmaDeg: value, limitDeg: value),
                .inconsistent(residualUt: value, limitUt: value),
                .fieldOutOfRange(fieldUt: value, lowUt: value, highUt: value),
            ]
            return [
                .rejected(reason: .outOfRange(valueUt: value, limitUt: value)),
                .rejected(reason: .saturated(axis: .y, valueUt: value, railUt: value)),
                .rejected(reason: .timeJump(gapS: value, limitS: value)),
            ] + problems.flatMap { [.collecting(missing: .fit(problem: $0)), .held(reason: .fitRefused(problem: $0))] }
        }
        for status in whole + real {
            #expect(status.localizedText.count > 10)
            _ = status.localizedGuidance
        }
        let nearest = number == 0 ? "x" : number < 0 ? "-z" : "z"
        #expect(whole[0].localizedText.contains(" \(nearest),-x,y "))
        let decoded = try JSONDecoder().decode(CompensationStatus.self, from: JSONEncoder().encode(whole[0]))
        #expect(decoded.localizedText == whole[0].localizedText)
        for sinceNs in [Int64.min, 0, .max] {
            let event = FieldEvent(kind: .deviceStep, sinceNs: sinceNs, decidedNs: Int64(number))
            #expect(event.localizedText.hasPrefix("the device's own disturbance changed"))
        }
    }

    /// A bundle as a folder, with a table.
    func bundle(_ table: String, _ texts: [String: String]) throws -> Bundle {
        let folder = FileManager.default.temporaryDirectory.appendingPathComponent(UUID().uuidString + ".bundle")
        let english = folder.appendingPathComponent("en.lproj")
        try FileManager.default.createDirectory(at: english, withIntermediateDirectories: true)
        let lines = texts.map { "\"\($0)\" = \"\($1)\";\n" }.joined()
        try lines.write(to: english.appendingPathComponent("\(table).strings"), atomically: true, encoding: .utf8)
        return try #require(Bundle(url: folder))
    }

    @Test func withoutThePackagesBundleThereAreWordsToo() throws {
        let (empty, texts) = (try bundle("Other", [:]), Texts(app: .main, package: nil))
        #expect(texts.say("missing_samples", [Int64(3), Int64(9)]) == "3 of 9 samples; turn the device about")
        #expect(Texts(app: empty, package: empty).say("status_tracking", []) == "tracking")
        // the same table
        for (key, english) in englishTexts {
            #expect(Texts.shared.say(key, []) == english)
        }
        #expect(englishTexts.count >= 60)
    }

    @Test(arguments: [
        ("de", "3 von 9 Messwerten; das Gerät drehen", "Das Telefon drehen."),
        ("es", "3 de 9 muestras; girar el dispositivo", "Girar el teléfono."),
    ])
    func thePackageHasOtherLanguages(_ language: String, _ samples: String, _ turn: String) throws {
        let folder = repository.appendingPathComponent("ios/Sources/Magcomp/Resources/\(language).lproj")
        let texts = Texts(app: .main, package: try #require(Bundle(url: folder)))
        #expect(texts.say("missing_samples", [Int64(3), Int64(9)]) == samples)
        #expect(texts.say("guidance_turn", []) == turn)
    }

    @Test func anAppMayRewordAndTranslate() throws {
        let app = try bundle(
            "Magcomp",
            [
                "status_tracking": "alles gut", "missing_samples": "%2$lld, davon %1$lld", "status_held": "%1$lld falsch",
                "guidance_turn": "",
            ])
        let package = try bundle("Localizable", ["status_tracking": "of the package", "guidance_eight": "an eight"])
        let texts = Texts(app: app, package: package)
        #expect(texts.say("status_tracking", []) == "alles gut")
        #expect(texts.say("missing_samples", [Int64(3), Int64(9)]) == "9, davon 3")
        #expect(texts.say("guidance_eight", []) == "an eight")
        // what asks for other values is left out, and so is nothing at all
        #expect(texts.say("status_held", [NSString("why")]) == "held: why")
        #expect(texts.say("guidance_turn", []) == "Turn the phone.")
    }
}
