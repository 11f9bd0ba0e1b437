// swift-tools-version: 6.0
import PackageDescription

// The same sources as the manifest of the repository, with their tests; no app reads this one. The native library, with its test hooks, is
// what cargo left in the folder MAGCOMP_NATIVE. Linux has stand-ins of Apple's frameworks and of the maps that the adapters serve.
#if os(Linux)
let (shared, frameworks) = ("so", ["ARKit", "CoreLocation", "CoreMotion", "SwiftUI", "UIKit", "simd"])
#else
let (shared, frameworks) = ("dylib", [String]())
#endif

func these(_ names: [String]) -> [Target.Dependency] { names.map { .byName(name: $0) } }

let folder = Context.environment["MAGCOMP_NATIVE"] ?? "\(Context.packageDirectory)/../target/release"
let maps = ["FerrostarCoreFFI", "FerrostarCore", "MapLibre"]
// what of the sample needs no screen
let ofApps = frameworks.isEmpty ? [] : ["Bridges", "CourseHelp", "FerrostarAdapter", "MapLibreAdapter"] + maps

var targets: [Target] = [
    .systemLibrary(name: "MagcompFFI", path: "Sources/MagcompFFI"),
    // what the feature `test-hooks` adds to the native library
    .systemLibrary(name: "MagcompTestHooks", path: "Tests/TestHooks"),
    .target(
        name: "Magcomp",
        dependencies: these(["MagcompFFI"] + frameworks),
        path: "Sources/Magcomp",
        resources: [.copy("PrivacyInfo.xcprivacy"), .process("Resources")],
        linkerSettings: [
            .unsafeFlags(["-Xlinker", "\(folder)/libmagcomp_ffi.\(shared)"]),
            // Swift 6.0's libswiftObservation.so lacks a symbol of the runtime, which it calls when all is lost
            .unsafeFlags(["-Xlinker", "--allow-shlib-undefined"], .when(platforms: [.linux])),
        ]
    ),
    .testTarget(
        name: "MagcompTests", dependencies: these(["Magcomp", "MagcompTestHooks"] + frameworks + ofApps),
        path: "Tests/MagcompTests"),
    .executableTarget(name: "Benchmark", dependencies: ["Magcomp", "MagcompTestHooks"], path: "Tests/Benchmark"),
]

/// A stand-in, as if of the Core Motion from which on the library asks for the authorization status.
func standIn(_ name: String, of others: [String] = []) -> Target {
    .target(
        name: name, dependencies: these(others), path: "Tests/\(name)",
        swiftSettings: [.unsafeFlags(["-user-module-version", "3186"])])
}

if !frameworks.isEmpty {
    targets += [
        standIn("simd"), standIn("ARKit", of: ["simd"]), standIn("CoreLocation"), standIn("CoreMotion"), standIn("UIKit"),
        standIn("SwiftUI", of: ["UIKit"]), standIn("FerrostarCoreFFI", of: ["CoreLocation"]),
        standIn("FerrostarCore", of: ["CoreLocation", "FerrostarCoreFFI"]), standIn("MapLibre", of: ["CoreLocation"]),
        .target(
            name: "FerrostarAdapter", dependencies: these(["Magcomp", "CoreLocation", "FerrostarCore", "FerrostarCoreFFI"]),
            path: "Adapters/Ferrostar"),
        .target(
            name: "MapLibreAdapter", dependencies: these(["Magcomp", "CoreLocation", "MapLibre"]), path: "Adapters/MapLibre"),
        .target(
            name: "CourseHelp", dependencies: these(["Magcomp", "CoreLocation"]), path: "Sample/Compass.swiftpm",
            exclude: ["CompassApp.swift", "CompassView.swift", "Package.swift"]),
        // what docs/FRAMEWORKS.md shows, with stand-ins of React Native and Flutter
        .target(
            name: "Bridges", dependencies: these(["Magcomp", "CoreMotion"]), path: "Tests/Bridges",
            swiftSettings: [.swiftLanguageMode(.v5)]),
    ]
}

// named as that of the repository: so are the folders of its resources
let package = Package(
    name: "magcomp", defaultLocalization: "en", platforms: [.iOS(.v17), .macOS(.v14)], targets: targets,
    swiftLanguageModes: [.v6])
