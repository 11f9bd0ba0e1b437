import Foundation
import Magcomp
import Testing

// what follows is README.md's; ReadmeTests compares them
func follow(_ compass: Compass, show: (String) -> Void) async throws {
    for try await answer in compass.readings() {
        let reading = answer.reading
        // without a heading, a sentence that says what is missing
        show(reading.heading.map { "\($0.headingDeg) deg +- \($0.headingSigmaDeg ?? 180)" } ?? reading.status.text)
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
        #expect(lines.first?.hasPrefix("collecting: ") == true)
        #expect(lines.last?.contains(" deg +- ") == true)
    }
}
