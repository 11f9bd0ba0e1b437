// swift-tools-version: 6.0
import PackageDescription

let package = Package(
    name: "App",
    platforms: [.iOS(.v17)],
    dependencies: [
        .package(url: "https://github.com/OWNER/magcomp", from: "0.1.0")
    ],
    targets: [
        .target(name: "App", dependencies: [.product(name: "Magcomp", package: "magcomp")])
    ]
)
