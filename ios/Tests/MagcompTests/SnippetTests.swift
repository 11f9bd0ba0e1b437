import Foundation
import Magcomp
import Testing

// What ios/README.md and the documentation show, compiled; a test compares them, but for the indentation.

#if canImport(CoreMotion) && !os(macOS)
func withoutSwiftUI() async throws {
    let compass = Compass()
    for try await answer in compass.readings() {
        if let headingDeg = answer.headingDeg {
            print("\(headingDeg) deg, give or take \(answer.headingSigmaDeg ?? 180)")
        } else {
            print(answer.localizedText)
        }
    }
}

func besideTheSystemsOwn(compare: (DeviceVector?, SensorSample.SystemField?) -> Void) async throws {
    let source = CoreMotionSource(options: CoreMotionSource.Options(systemField: true))
    for try await answer in Compass(source: source, store: UserDefaultsStore()).readings() {
        compare(answer.reading.fieldUt, answer.systemField)
    }
}
#endif

func recordForAReport(_ compass: Compass, _ folder: URL) throws -> Compass.Recording {
    // before the first reading: then it plays as it was
    let recording = try compass.record(to: folder.appendingPathComponent("compass.csv"))
    return recording
}

func share(_ recording: Compass.Recording) throws -> [URL] {
    try recording.close()
    return recording.urls
}

func play(_ url: URL, compare: (CompensatedReading) -> Void) async throws {
    for try await answer in Compass(source: RecordingSource(url: url)).readings() { compare(answer) }
}

func trueNorth(_ compass: Compass) throws {
    let place = try EarthMagneticField(latitudeDeg: 48.86, longitudeDeg: 2.35, heightM: 35, date: Date())
    try compass.setDeclinationDeg(place.declinationDeg)
}

func placeNorth(_ compass: Compass, place: (SIMD3<Double>) -> Void) {
    // nil before there are both, and where nobody has told a pose for a second
    if let north = compass.arWorldNorth, north.sigmaDeg < 15 { place(north.direction) }
}

func onLandmark(_ compass: Compass, bearingDeg: Double) throws {
    let camera = SensorSample.HeadedAxis.device(axis: DeviceVector(x: 0, y: 0, z: -1))
    try compass.aid(
        with: SensorSample.Heading(
            timeNs: SensorSample.Heading.timeNs(of: Date()), headingDeg: bearingDeg, sigmaDeg: 5, reference: .true,
            axis: camera))
}

#if canImport(CoreLocation)
import CoreLocation

func onFix(_ compass: Compass, _ fix: CLLocation) throws {
    // in a holder in a car; `.heldAhead`: its user walks and holds it ahead
    let isTaken = try compass.aid(with: fix, pointing: .vehicle)
    if !isTaken { print("no course, too slow, too late, or nobody reads") }
    // true north, where the place is known
    try compass.setPlace(fix)
}
#endif

#if canImport(UIKit) && os(iOS)
import UIKit

@MainActor func onTurn(_ compass: Compass, _ scene: UIWindowScene) {
    if let rotation = HeadingFrame.ScreenRotation(scene.effectiveGeometry.interfaceOrientation) {
        compass.screenRotation = rotation
    }
}
#endif

#if canImport(ARKit) && !os(macOS)
import ARKit
import simd

final class CameraHelp: NSObject, ARSessionDelegate {
    private let compass: Compass

    init(_ compass: Compass) { self.compass = compass }

    func session(_ session: ARSession, didUpdate frame: ARFrame) {
        guard case .normal = frame.camera.trackingState else { return }
        _ = try? compass.aid(arKitCamera: frame.camera.transform, timestampS: frame.timestamp)
    }
}
#endif

#if canImport(Bridges)
@testable import Bridges
#endif

@Suite struct SnippetTests {
    private let catalog = "ios/Sources/Magcomp/Magcomp.docc"

    /// The lines of a Swift text, without their indentation.
    private func lines(_ text: some StringProtocol) -> String {
        text.split(separator: "\n").map { $0.trimmingCharacters(in: .whitespaces) }.joined(separator: "\n")
    }

    private func text(_ path: String) throws -> String {
        try String(contentsOf: repository.appendingPathComponent(path), encoding: .utf8)
    }

    @Test func whatIsShownIsCompiledHere() throws {
        let here = lines(try String(contentsOfFile: #filePath, encoding: .utf8))
        // SwiftUI and UIKit are not on Linux: the tutorial's last file, which is parsed, and the sample have these
        let view = lines(try text("\(catalog)/Resources/CompassView-3.swift"))
        let sample = lines(try text("ios/Sample/Compass.swiftpm/CompassView.swift"))
        let bridges = lines(try text("ios/Tests/Bridges/Bridges.swift"))
        let pages = try FileManager.default.contentsOfDirectory(atPath: repository.appendingPathComponent(catalog).path)
            .filter { $0.hasSuffix(".md") }.map { "\(catalog)/\($0)" }
        var count = 0
        for page in pages + ["ios/README.md", "docs/FRAMEWORKS.md"] {
            // Linux has no Objective-C
            let shown = try text(page).replacingOccurrences(of: "@objc(Magcomp) ", with: "")
            for block in shown.components(separatedBy: "```swift\n").dropFirst() {
                let code = lines(try #require(block.components(separatedBy: "```").first))
                let isThere = [here, view, sample, bridges].contains { $0.contains(code) }
                #expect(isThere, "\(page): \(code)")
                count += 1
            }
        }
        #expect(count > 10, "\(count)")
    }

    #if canImport(Bridges)
    /// The stand-in's phone has no sensors before a test plays some.
    @MainActor @Test func theBridgesTellReactNativeAndFlutterWhatIsMissing() async throws {
        let (module, handler) = (MagcompModule(), HeadingHandler())
        var heard: [[String: Any]] = []
        module.startObserving()
        #expect(handler.onListen(withArguments: nil) { heard.append($0 as? [String: Any] ?? [:]) } == nil)
        try await eventually { !module.sent.isEmpty && !heard.isEmpty }
        module.stopObserving()
        #expect(handler.onCancel(withArguments: nil) == nil)
        for told in [module.sent[0], heard[0]] {
            #expect(told.keys.sorted() == ["headingDeg", "sigmaDeg", "text"])
            #expect(told["headingDeg"] as? Double == nil && told["text"] as? String == "the magnetometer delivers nothing")
        }
    }

    /// A reading that is on its way when nobody listens any more.
    @MainActor @Test func theBridgesTellNothingAfterTheirEnd() async throws {
        let (source, count) = (PushedSource(holdS: 0), Shared(0))
        let running = told(Compass(source: source)) { _ in count.change { $0 += 1 } }
        try await eventually { source.listeners == 1 }
        source.push(flat(0))
        running.cancel()
        await running.value
        #expect(count.value == 0)
    }
    #endif

    @Test func aLandmarkThatNobodyReadsChangesNothing() throws {
        try onLandmark(Compass(source: Played(events: [])), bearingDeg: 10)
    }

    #if canImport(CoreLocation)
    private func fix(course: Double, agoS: Double = 0, horizontalAccuracy: Double = 5) -> CLLocation {
        CLLocation(
            coordinate: CLLocationCoordinate2D(latitude: 48.86, longitude: 2.35), altitude: 35,
            horizontalAccuracy: horizontalAccuracy, verticalAccuracy: 5, course: course, courseAccuracy: 2, speed: 15,
            speedAccuracy: 1, timestamp: Date(timeIntervalSinceNow: -agoS))
    }

    /// Sensors that count from the start of the device, as a phone's.
    private func driven(_ compass: Compass, _ source: Live, _ body: () throws -> Void) async throws {
        let seen = Shared<[CompensatedReading]>([])
        let task = reader(compass, seen)
        try await source.started(1)
        let timeNs = Int64(ProcessInfo.processInfo.systemUptime * 1e9)
        source.play([.magnetic(SensorSample.Magnetic(timeNs: timeNs, fieldUt: DeviceVector(x: 1, y: 2, z: 3)))])
        try await eventually { seen.value.count == 1 }
        try body()
        task.cancel()
        try await task.value
    }

    @Test func aFixHelpsByItsCourseAtItsOwnTime() async throws {
        let source = Live()
        let compass = Compass(source: source)
        try onFix(compass, fix(course: 90))
        #expect(try compass.declinationDeg == EarthMagneticField(at: fix(course: 90)).declinationDeg)
        #expect(try !compass.aid(with: fix(course: 90), pointing: .vehicle), "nobody reads")
        try await driven(compass, source) { () throws in
            #expect(try !compass.aid(with: fix(course: -1), pointing: .vehicle), "no course")
            #expect(try !compass.aid(with: fix(course: 90, agoS: 60), pointing: .vehicle), "too late")
            #expect(try compass.aid(with: fix(course: 90, agoS: 2), pointing: .vehicle))
        }
        #expect(throws: MagcompError.self) { try EarthMagneticField(at: fix(course: 90, horizontalAccuracy: -1)) }
    }

    #if canImport(ARKit) && !os(macOS)
    @Test func aCameraHelpsWhileItTracks() async throws {
        let source = Live()
        let compass = Compass(source: source)
        let help = CameraHelp(compass)
        // flat, the top edge along -z of ARKit's world
        let transform = simd_float4x4(
            SIMD4(0, 0, 1, 0), SIMD4(1, 0, 0, 0), SIMD4(0, 1, 0, 0), SIMD4(0, 0, 0, 1))
        func frame(_ state: ARCamera.TrackingState, _ timestampS: Double) -> ARFrame {
            ARFrame(timestamp: timestampS, camera: ARCamera(transform: transform, trackingState: state))
        }
        try await driven(compass, source) { () throws in
            let nowS = ProcessInfo.processInfo.systemUptime
            let lost = frame(.limited(.relocalizing), nowS)
            help.session(ARSession(), didUpdate: lost)
            // the time of the one that was lost is still to be had, that of the one that was taken is not
            #expect(try compass.aid(arKitCamera: transform, timestampS: nowS))
            help.session(ARSession(), didUpdate: frame(.normal, nowS + 0.1))
            #expect(try !compass.aid(arKitCamera: transform, timestampS: nowS + 0.1))
        }
    }
    #endif
    #endif
}
