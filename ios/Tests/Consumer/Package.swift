// swift-tools-version: 6.0
// An app's own package, which has this one by its path, as the README says: `tests/swift.sh` builds and runs it.
import PackageDescription

let package = Package(
    name: "Consumer",
    platforms: [.macOS(.v14)],
    dependencies: [.package(name: "magcomp", path: "../../..")],
    targets: [
        .target(name: "Other", path: "Other"),
        .executableTarget(
            name: "Consumer", dependencies: ["Other", .product(name: "Magcomp", package: "magcomp")], path: "App"),
    ],
    swiftLanguageModes: [.v6]
)
