// swift-tools-version: 6.0
import PackageDescription

// What an app gets. The tests, with stand-ins of Apple's frameworks, have a manifest of their own: ios/Package.swift.
// `ios/build-xcframework.sh --release URL` fills this in: where a release's XCFramework is, and its checksum.
let release: (url: String, checksum: String)? = nil

// The native library is an XCFramework: that of a release, or one in a folder of this package, which `ios/build-xcframework.sh` makes.
// A test of it on Linux takes what cargo left in the folder MAGCOMP_NATIVE.
let ofCargo = Context.environment["MAGCOMP_NATIVE"]
let built = Context.environment["MAGCOMP_XCFRAMEWORK"]

let native: Target =
    if ofCargo != nil {
        .systemLibrary(name: "MagcompFFI", path: "ios/Sources/MagcompFFI")
    } else if let release, built == nil {
        .binaryTarget(name: "MagcompFFI", url: release.url, checksum: release.checksum)
    } else {
        .binaryTarget(name: "MagcompFFI", path: built ?? "target/ios/MagcompFFI.xcframework")
    }

let package = Package(
    name: "magcomp",
    defaultLocalization: "en",
    platforms: [.iOS(.v17), .macOS(.v14)],
    products: [.library(name: "Magcomp", targets: ["Magcomp"])],
    targets: [
        native,
        .target(
            name: "Magcomp",
            dependencies: ["MagcompFFI"],
            path: "ios/Sources/Magcomp",
            resources: [.copy("PrivacyInfo.xcprivacy"), .process("Resources")],
            // Swift 6.0's libswiftObservation.so lacks a symbol of the runtime, which it calls when all is lost
            linkerSettings: ofCargo.map {
                [.unsafeFlags(["-Xlinker", "\($0)/libmagcomp_ffi.so", "-Xlinker", "--allow-shlib-undefined"])]
            }
        ),
    ],
    swiftLanguageModes: [.v6]
)
