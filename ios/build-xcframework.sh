#!/usr/bin/env bash
# The native library as target/ios/MagcompFFI.xcframework: static libraries for iOS devices, for simulators and for macOS,
# these two for Apple silicon and Intel, with headers and module map. On a Mac with Xcode and Rust's targets (rustup target
# add aarch64-apple-ios aarch64-apple-ios-sim x86_64-apple-ios aarch64-apple-darwin x86_64-apple-darwin); on Debian, without
# Xcode, with llvm, to check the structure: what ships is built on a Mac. PROFILE is cargo's: on a Mac `ship`, elsewhere by default the quicker `dev`.
# `--device` leaves out all but the devices' slice, for a check: apps then build for devices alone.
# With `--release URL` it also packs target/ios/MagcompFFI.xcframework.zip and writes URL and checksum into Package.swift;
# `--pack URL` does no more than that, with the framework that is there, for one that was checked and signed meanwhile; `--zip` packs
# alone. The same files always give the same zip: they are sorted, and have one time.
# OBJCOPY is LLVM's objcopy, which takes out bitcode, by default that of Rust's toolchain (rustup component add llvm-tools).
set -euo pipefail
cd "$(dirname "$0")/.."
case "$#:${1:-}" in
    0: | 1:--device | 1:--zip | 2:--release | 2:--pack) ;;
    *) echo "usage: ios/build-xcframework.sh [--device | --zip | --release URL | --pack URL]" >&2; exit 2 ;;
esac
# cargo does not know that a build depends on it: another one needs another target folder
export IPHONEOS_DEPLOYMENT_TARGET=17.0 MACOSX_DEPLOYMENT_TARGET=14.0
target=$(realpath -m "${CARGO_TARGET_DIR:-target}" 2>/dev/null || echo "$PWD/target")
std=()
lipo=lipo
profile=${PROFILE:-ship}
export CARGO_TARGET_DIR=$target/ios-build
if [ "$(uname)" != Darwin ]; then
    . tests/need.sh
    need xcframework zip:zip
fi
if [ "$(uname)" != Darwin ] && [[ "${1:-}" != --zip && "${1:-}" != --pack ]]; then
    # its folder is that of tests/mobile.sh, which uses the same compiler
    export CARGO_TARGET_DIR=$target/mobile
    need_llvm xcframework llvm-lipo:llvm llvm-objcopy:llvm
    lipo=llvm-lipo$llvm
    profile=${PROFILE:-dev}
    OBJCOPY=${OBJCOPY:-llvm-objcopy$llvm}
fi

framework=$target/ios/MagcompFFI.xcframework
checksum() { (sha256sum "$1" 2>/dev/null || shasum -a 256 "$1") | cut -d' ' -f1; }
rm -f "$framework.zip"

# slice FOLDER RUST_TARGET...
slice() {
    local folder=$1 rust library libraries=()
    for rust in "${@:2}"; do
        # with what rustup's has: backtraces
        [ "$(uname)" = Darwin ] || need_std xcframework "$rust" panic-unwind,backtrace
        # not `cargo build`: the shared library would need Apple's linker
        cargo rustc --quiet --locked --profile "$profile" -p magcomp-ffi --lib --crate-type staticlib ${std[@]+"${std[@]}"} --target "$rust"
        library=$CARGO_TARGET_DIR/$rust/libmagcomp_ffi.a
        # what the standard library keeps for link-time optimisation, which no app links and Apple no longer takes
        "$OBJCOPY" --remove-section=__LLVM,__bitcode --remove-section=__LLVM,__cmdline "$CARGO_TARGET_DIR/$rust/${profile/#dev/debug}/libmagcomp_ffi.a" "$library"
        libraries+=("$library")
    done
    # Xcode copies what is in Headers into one folder for all frameworks of an app: ours has a folder of its own in it, or
    # the module map would meet another framework's ("Multiple commands produce include/module.modulemap")
    local headers=$framework/$folder/Headers/MagcompFFI
    mkdir -p "$headers"
    if [ ${#libraries[@]} = 1 ]; then
        cp "${libraries[0]}" "$framework/$folder/"
    else
        $lipo -create "${libraries[@]}" -output "$framework/$folder/libmagcomp_ffi.a"
    fi
    cp bindings/swift/MagcompFFI.h rust/magcomp-ffi/include/magcomp.h "$headers/"
    cat >"$headers/module.modulemap" <<'MODULE'
module MagcompFFI {
    header "MagcompFFI.h"
    header "magcomp.h"
    export *
}
MODULE
}
# what `xcodebuild -create-xcframework` would write
library() { # PLATFORM-ARCHITECTURES, and for simulators -VARIANT
    local platform architectures variant
    IFS=- read -r platform architectures variant <<<"$1"
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
$(for architecture in ${architectures/_x86_64/ x86_64}; do echo "				<string>$architecture</string>"; done)
			</array>
			<key>SupportedPlatform</key>
			<string>$platform</string>
${variant:+			<key>SupportedPlatformVariant</key>
			<string>$variant</string>
}		</dict>
LIBRARY
}
build() { # all slices, or the devices' alone
    rm -rf "$framework"
    slice ios-arm64 aarch64-apple-ios
    if [ "${1:-}" != --device ]; then
        slice ios-arm64_x86_64-simulator aarch64-apple-ios-sim x86_64-apple-ios
        slice macos-arm64_x86_64 aarch64-apple-darwin x86_64-apple-darwin
    fi
    cp LICENSE-MIT LICENSE-APACHE ios/THIRD-PARTY-NOTICES "$framework/"
    cat >"$framework/Info.plist" <<PLIST
<?xml version="1.0" encoding="UTF-8"?>
<!DOCTYPE plist PUBLIC "-//Apple//DTD PLIST 1.0//EN" "http://www.apple.com/DTDs/PropertyList-1.0.dtd">
<plist version="1.0">
<dict>
	<key>AvailableLibraries</key>
	<array>
$(for folder in "$framework"/*/; do library "$(basename "$folder")"; done)
	</array>
	<key>CFBundlePackageType</key>
	<string>XFWK</string>
	<key>XCFrameworkFormatVersion</key>
	<string>1.0</string>
</dict>
</plist>
PLIST
    echo "xcframework: $framework"
}
# a zip has local times, without a zone, and whatever order it is given
pack() {
    export TZ=UTC LC_ALL=C
    find "$framework" -exec touch -t 198001010000 {} +
    (cd "$target/ios" && find MagcompFFI.xcframework -type f | sort | zip -qX -@ MagcompFFI.xcframework.zip)
    echo "xcframework: $framework.zip, $(checksum "$framework.zip")"
}
case "${1:-}" in
    --zip | --pack) ;;
    *)
        if [ "$(uname)" = Darwin ] && [ -z "${OBJCOPY:-}" ]; then
            OBJCOPY=$(rustc --print sysroot)/lib/rustlib/$(rustc -vV | sed -n 's/^host: //p')/bin/rust-objcopy
            [ -x "$OBJCOPY" ] || OBJCOPY=${OBJCOPY%rust-objcopy}llvm-objcopy
            [ -x "$OBJCOPY" ] || { echo "xcframework: missing: LLVM's objcopy; rustup component add llvm-tools" >&2; exit 1; }
        fi
        build "$@"
        ;;
esac
case "$#:${1:-}" in 2:* | 1:--zip) pack ;; esac

if [ $# = 2 ]; then
    # SwiftPM's checksum is SHA-256
    checksum=$(checksum "$framework.zip")
    line="let release: (url: String, checksum: String)? = (\"$2\", \"$checksum\")"
    # awk by the environment: in a replacement of sed's an & of the URL would mean something
    line=$line awk '/^let release: / { print ENVIRON["line"]; next } { print }' Package.swift >"$target/ios/Package.swift"
    grep -qF "$line" "$target/ios/Package.swift" || { echo "xcframework: Package.swift has no line for the release" >&2; exit 1; }
    cat "$target/ios/Package.swift" >Package.swift
    echo "xcframework: $framework.zip, $checksum; attach it to the release at $2 and commit Package.swift"
fi
