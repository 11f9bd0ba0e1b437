// swift-tools-version: 6.0
// Opens in Xcode and in Swift Playgrounds as an app.
import AppleProductTypes
import PackageDescription

let package = Package(
    name: "Compass",
    platforms: [.iOS("17.0")],
    products: [
        .iOSApplication(
            name: "Compass",
            targets: ["Compass"],
            bundleIdentifier: "org.magcomp.sample",
            displayVersion: "1.0",
            bundleVersion: "1",
            supportedDeviceFamilies: [.phone],
            supportedInterfaceOrientations: [.portrait, .landscapeLeft, .landscapeRight, .portraitUpsideDown],
            capabilities: [
                .motion(purposeString: "The compass uses the motion sensors to find north."),
                .locationWhenInUse(purposeString: "A course helps the compass where magnets disturb it."),
            ]
        )
    ],
    dependencies: [.package(name: "magcomp", path: "../../..")],
    targets: [
        .executableTarget(
            name: "Compass",
            dependencies: [.product(name: "Magcomp", package: "magcomp")],
            path: "."
        )
    ],
    swiftLanguageModes: [.v6]
)
