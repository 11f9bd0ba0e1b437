// swift-tools-version: 6.0
import Foundation
import PackageDescription

// The native library: on Apple platforms an XCFramework, that of a release or, with MAGCOMP_XCFRAMEWORK, one in a folder
// of this package (`ios/build-xcframework.sh` makes it); on Linux what `cargo build --release -p magcomp-ffi` left in
// target/release, or in the folder MAGCOMP_NATIVE, which a Mac uses too where it is given: the tests need its hooks.
// With MAGCOMP_RELEASE=1 it is what an app gets of a release, on Linux too, for the tests of this manifest.
// `ios/build-xcframework.sh --release URL` fills this in: where a release's XCFramework is, and its checksum.
let release: (url: String, checksum: String)? = nil

let environment = Context.environment
let localFramework = "target/ios/MagcompFFI.xcframework"

let isRelease = environment["MAGCOMP_RELEASE"] == "1"
#if os(Linux)
let (fromCargo, shared) = (environment["MAGCOMP_XCFRAMEWORK"] == nil && !isRelease, "so")
#else
let (fromCargo, shared) = (environment["MAGCOMP_NATIVE"] != nil && !isRelease, "dylib")
#endif

let native: Target =
    if fromCargo {
        .systemLibrary(name: "MagcompFFI", path: "ios/Sources/MagcompFFI")
    } else if let release, environment["MAGCOMP_XCFRAMEWORK"] == nil {
        .binaryTarget(name: "MagcompFFI", url: release.url, checksum: release.checksum)
    } else {
        .binaryTarget(name: "MagcompFFI", path: built(environment["MAGCOMP_XCFRAMEWORK"] ?? localFramework))
    }

/// A framework that is there: else the package manager would say no more than that it "does not contain a binary artifact".
func built(_ framework: String) -> String {
    let place = framework.hasPrefix("/") ? framework : "\(Context.packageDirectory)/\(framework)"
    if !FileManager.default.fileExists(atPath: place) {
        fatalError(
            "magcomp: \(place) is missing. This is a state of the repository without a release: build its native library on a Mac by "
                + "ios/build-xcframework.sh, as ios/README.md says under 'Building it', or take a version that is released")
    }
    return framework
}
let folder = environment["MAGCOMP_NATIVE"] ?? "\(Context.packageDirectory)/target/release"
// allow-shlib-undefined: Swift 6.0's libswiftObservation.so lacks a symbol of the runtime, which it calls when all is lost
let linking: [LinkerSetting] =
    fromCargo
    ? [
        .unsafeFlags(["-Xlinker", "\(folder)/libmagcomp_ffi.\(shared)"]),
        .unsafeFlags(["-Xlinker", "--allow-shlib-undefined"], .when(platforms: [.linux])),
    ] : []

// Stand-ins of Apple's frameworks, for this package's own tests on Linux
let isAlone = fromCargo && environment["MAGCOMP_FRAMEWORKS"] == "stand-in"
let frameworks = isAlone ? ["ARKit", "CoreLocation", "CoreMotion", "SwiftUI", "UIKit", "simd"] : []
// of the maps that the adapters serve
let maps = isAlone ? ["FerrostarCoreFFI", "FerrostarCore", "MapLibre"] : []
let standIns = frameworks.map { Target.Dependency(stringLiteral: $0) }
// what of the sample needs no screen
let sample: [Target.Dependency] =
    frameworks.isEmpty ? [] : ["CourseHelp", "FerrostarAdapter", "MapLibreAdapter"] + maps.map { .init(stringLiteral: $0) }

var targets: [Target] = [
    native,
    .target(
        name: "Magcomp",
        dependencies: ["MagcompFFI"] + standIns,
        path: "ios/Sources/Magcomp",
        resources: [.copy("PrivacyInfo.xcprivacy"), .process("Resources")],
        linkerSettings: linking
    ),
]
if fromCargo {
    // what the feature `test-hooks` adds to the native library
    targets += [
        .systemLibrary(name: "MagcompTestHooks", path: "ios/Tests/TestHooks"),
        .testTarget(
            name: "MagcompTests",
            dependencies: ["Magcomp", "MagcompTestHooks"] + standIns + sample,
            path: "ios/Tests/MagcompTests"
        ),
        .executableTarget(
            name: "Benchmark",
            dependencies: ["Magcomp", "MagcompTestHooks"],
            path: "ios/Tests/Benchmark"
        ),
    ]
}
targets += frameworks.map {
    // the version of Core Motion from which on the library asks for the authorization status
    .target(
        name: $0, dependencies: $0 == "ARKit" ? ["simd"] : $0 == "SwiftUI" ? ["UIKit"] : [], path: "ios/Tests/\($0)",
        swiftSettings: [.unsafeFlags(["-user-module-version", "3186"])])
}

if !frameworks.isEmpty {
    targets += maps.map {
        .target(
            name: $0, dependencies: ["CoreLocation"] + ($0 == "FerrostarCore" ? ["FerrostarCoreFFI"] : []),
            path: "ios/Tests/\($0)")
    }
    targets += [("Ferrostar", ["FerrostarCore", "FerrostarCoreFFI"]), ("MapLibre", ["MapLibre"])].map { name, modules in
        .target(
            name: "\(name)Adapter",
            dependencies: ["Magcomp", "CoreLocation"] + modules.map { Target.Dependency(stringLiteral: $0) },
            path: "ios/Adapters/\(name)")
    }
    targets.append(
        .target(
            name: "CourseHelp", dependencies: ["Magcomp", "CoreLocation"], path: "ios/Sample/Compass.swiftpm",
            exclude: ["CompassApp.swift", "CompassView.swift", "Package.swift"]))
}

let package = Package(
    name: "magcomp",
    defaultLocalization: "en",
    platforms: [.iOS(.v17), .macOS(.v14)],
    products: [.library(name: "Magcomp", targets: ["Magcomp"])],
    targets: targets,
    swiftLanguageModes: [.v6]
)
