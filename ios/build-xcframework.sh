#!/usr/bin/env bash
# The native library for iOS as target/ios/MagcompFFI.xcframework: static libraries for devices and for simulators on
# Apple silicon, with headers and module map. On a Mac with Xcode and Rust's targets aarch64-apple-ios and
# aarch64-apple-ios-sim (rustup target add); on Debian, without Xcode, with Debian's rustc-web, cargo-web and rust-web-src,
# to check the structure: what ships is built on a Mac.
# `--device` leaves out the simulators' slice, for a check: apps then build for devices alone.
# With `--release URL` it also packs target/ios/MagcompFFI.xcframework.zip and writes URL and checksum into Package.swift.
set -euo pipefail
cd "$(dirname "$0")/.."
case "$#:${1:-}" in
    0: | 1:--device | 2:--release) ;;
    *) echo "usage: ios/build-xcframework.sh [--device | --release URL]" >&2; exit 2 ;;
esac
# cargo does not know that a build depends on it: another one needs another target folder
export IPHONEOS_DEPLOYMENT_TARGET=15.0
target=$(realpath -m "${CARGO_TARGET_DIR:-target}" 2>/dev/null || echo "$PWD/target")
std=()
export CARGO_TARGET_DIR=$target/ios-build
if [ "$(uname)" != Darwin ]; then
    . tests/need.sh
    need xcframework "${debian_rust[@]}" $([ "${1:-}" != --release ] || echo zip:zip)
    # Debian's own Rust, which brings the source of std; its folder is that of tests/mobile.sh, which uses the same compiler
    export PATH=/usr/bin:$PATH RUSTC_BOOTSTRAP=1 CARGO_TARGET_DIR=$target/mobile
    unset RUSTUP_TOOLCHAIN RUSTFLAGS
    # with what rustup's has: backtraces
    std=(-Zbuild-std=std,panic_abort -Zbuild-std-features=panic-unwind,backtrace)
fi

framework=$target/ios/MagcompFFI.xcframework
rm -rf "$framework" "$framework.zip"

# slice RUST_TARGET FOLDER
slice() {
    # not `cargo build`: the shared library would need Apple's linker
    cargo rustc --quiet --locked --profile ship -p magcomp-ffi --lib --crate-type staticlib ${std[@]+"${std[@]}"} --target "$1"
    # Xcode copies what is in Headers into one folder for all frameworks of an app: ours has a folder of its own in it, or
    # the module map would meet another framework's ("Multiple commands produce include/module.modulemap")
    local headers=$framework/$2/Headers/MagcompFFI
    mkdir -p "$headers"
    cp "$CARGO_TARGET_DIR/$1/ship/libmagcomp_ffi.a" "$framework/$2/"
    cp bindings/swift/MagcompFFI.h rust/magcomp-ffi/include/magcomp.h "$headers/"
    cat >"$headers/module.modulemap" <<'MODULE'
module MagcompFFI {
    header "MagcompFFI.h"
    header "magcomp.h"
    export *
}
MODULE
}
slice aarch64-apple-ios ios-arm64
[ "${1:-}" = --device ] || slice aarch64-apple-ios-sim ios-arm64-simulator

# what `xcodebuild -create-xcframework` would write
library() { # FOLDER, and for simulators the variant
    cat <<LIBRARY
		<dict>
			<key>BinaryPath</key>
			<string>libmagcomp_ffi.a</string>
			<key>HeadersPath</key>
			<string>Headers</string>
			<key>LibraryIdentifier</key>
			<string>$1</string>
			<key>LibraryPath</key>
			<string>libmagcomp_ffi.a</string>
			<key>SupportedArchitectures</key>
			<array>
				<string>arm64</string>
			</array>
			<key>SupportedPlatform</key>
			<string>ios</string>
${2:+			<key>SupportedPlatformVariant</key>
			<string>$2</string>
}		</dict>
LIBRARY
}
cat >"$framework/Info.plist" <<PLIST
<?xml version="1.0" encoding="UTF-8"?>
<!DOCTYPE plist PUBLIC "-//Apple//DTD PLIST 1.0//EN" "http://www.apple.com/DTDs/PropertyList-1.0.dtd">
<plist version="1.0">
<dict>
	<key>AvailableLibraries</key>
	<array>
$(library ios-arm64)
$([ "${1:-}" = --device ] || library ios-arm64-simulator simulator)
	</array>
	<key>CFBundlePackageType</key>
	<string>XFWK</string>
	<key>XCFrameworkFormatVersion</key>
	<string>1.0</string>
</dict>
</plist>
PLIST
echo "xcframework: $framework"

if [ $# = 2 ]; then
    (cd "$target/ios" && zip -qrX MagcompFFI.xcframework.zip MagcompFFI.xcframework)
    # SwiftPM's checksum is SHA-256
    checksum=$( (sha256sum "$framework.zip" 2>/dev/null || shasum -a 256 "$framework.zip") | cut -d' ' -f1)
    line="let release: (url: String, checksum: String)? = (\"$2\", \"$checksum\")"
    sed "s|^let release: .*|$line|" Package.swift >"$target/ios/Package.swift"
    grep -qF "$line" "$target/ios/Package.swift" || { echo "xcframework: Package.swift has no line for the release" >&2; exit 1; }
    cat "$target/ios/Package.swift" >Package.swift
    echo "xcframework: $framework.zip, $checksum; attach it to the release at $2 and commit Package.swift"
fi
