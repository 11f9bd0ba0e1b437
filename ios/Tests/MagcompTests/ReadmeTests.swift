import Foundation
import Magcomp
import Testing

// what follows is README.md's; ReadmeTests compares them
func follow(_ compass: Compass, show: (String) -> Void) async throws {
    for try await answer in compass.readings() {
        // without a heading, a sentence for people that says what is missing
        show(answer.headingDeg.map { "\($0) deg +- \(answer.headingSigmaDeg ?? 180)" } ?? answer.localizedText)
    }
}

@Suite struct ReadmeTests {
    @Test func theFirstPagesSnippetIsTheOneThatIsCompiledAndRunHere() async throws {
        let source = try String(contentsOfFile: #filePath, encoding: .utf8)
        let rest = try #require(source.components(separatedBy: "func follow").dropFirst().first)
        let code = try #require(rest.components(separatedBy: "\n}\n").first)
        let readme = try String(contentsOf: repository.appendingPathComponent("README.md"), encoding: .utf8)
        #expect(readme.contains("func follow\(code)\n}\n"))

        var lines: [String] = []
        try await follow(Compass(source: Played(events: tumbling(600), isLive: false))) { lines.append($0) }
        // in the app's own words, which a test's bundle does not have: English
        #expect(lines.first == "collecting: 1 of 16 samples; turn the device about")
        #expect(lines.last?.contains(" deg +- ") == true)
    }
}
