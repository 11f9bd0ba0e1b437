// swift-tools-version: 6.0
import PackageDescription

// The native library: on Apple platforms an XCFramework, that of a release or, with MAGCOMP_XCFRAMEWORK, one in a folder
// of this package (`ios/build-xcframework.sh` makes it); on Linux what `cargo build --release -p magcomp-ffi` left in
// target/release, or in the folder MAGCOMP_NATIVE.
// `ios/build-xcframework.sh --release URL` fills this in: where a release's XCFramework is, and its checksum.
let release: (url: String, checksum: String)? = nil

let environment = Context.environment
let localFramework = "target/ios/MagcompFFI.xcframework"

#if os(Linux)
let onLinux = environment["MAGCOMP_XCFRAMEWORK"] == nil
#else
let onLinux = false
#endif

let native: Target =
    if onLinux {
        .systemLibrary(name: "MagcompFFI", path: "ios/Sources/MagcompFFI")
    } else if let release, environment["MAGCOMP_XCFRAMEWORK"] == nil {
        .binaryTarget(name: "MagcompFFI", url: release.url, checksum: release.checksum)
    } else {
        .binaryTarget(name: "MagcompFFI", path: environment["MAGCOMP_XCFRAMEWORK"] ?? localFramework)
    }
let folder = environment["MAGCOMP_NATIVE"] ?? "\(Context.packageDirectory)/target/release"
// allow-shlib-undefined: Swift 6.0's libswiftObservation.so lacks a symbol of the runtime, which it calls when all is lost
let linking: [LinkerSetting] =
    onLinux
    ? [.unsafeFlags(["-Xlinker", "\(folder)/libmagcomp_ffi.so", "-Xlinker", "--allow-shlib-undefined"])]
    : []

// Stand-ins of Apple's frameworks, for this package's own tests on Linux
let frameworks = onLinux && environment["MAGCOMP_FRAMEWORKS"] == "stand-in" ? ["Combine", "CoreMotion"] : []
let standIns = frameworks.map { Target.Dependency(stringLiteral: $0) }

var targets: [Target] = [
    native,
    .target(
        name: "MagcompBindings",
        dependencies: ["MagcompFFI"],
        path: "bindings/swift",
        exclude: ["MagcompFFI.h", "MagcompFFI.modulemap"],
        linkerSettings: linking
    ),
    .target(
        name: "Magcomp",
        dependencies: ["MagcompBindings", "MagcompFFI"] + standIns,
        path: "ios/Sources/Magcomp",
        resources: [.copy("PrivacyInfo.xcprivacy")]
    ),
]
if onLinux {
    // what the feature `test-hooks` adds to the native library
    targets += [
        .systemLibrary(name: "MagcompTestHooks", path: "ios/Tests/TestHooks"),
        .testTarget(
            name: "MagcompTests",
            dependencies: ["Magcomp", "MagcompTestHooks"] + standIns,
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
    .target(name: $0, path: "ios/Tests/\($0)", swiftSettings: [.unsafeFlags(["-user-module-version", "3186"])])
}

let package = Package(
    name: "magcomp",
    platforms: [.iOS(.v15)],
    products: [.library(name: "Magcomp", targets: ["Magcomp"])],
    targets: targets,
    swiftLanguageModes: [.v6]
)
