#!/usr/bin/env bash
# Builds the Android libraries that ship, with the NDK (r28 or newer: 16 KB pages) through cargo-ndk, into
# target/android/<abi>. Then `mvn -f android/pom.xml verify -Prelease` packs the AAR, which refuses any other libraries.
# Needs: cargo-ndk, ANDROID_NDK_HOME, and rustup with the four Android targets and the component rust-src.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v cargo-ndk >/dev/null || { echo "build-native: cargo-ndk is missing: cargo install cargo-ndk" >&2; exit 1; }
[ -d "${ANDROID_NDK_HOME:-}" ] || { echo "build-native: ANDROID_NDK_HOME names no folder; install the NDK, r28 or newer" >&2; exit 1; }
# std without its printing of backtraces, which is 130 kB; panics are caught and logged at the border
export RUSTC_BOOTSTRAP=1
export RUSTFLAGS="-Clink-arg=-Wl,-z,max-page-size=16384 -Clink-arg=-Wl,-soname,libmagcomp_ffi.so -Clink-arg=-Wl,-T,$PWD/android/no-metadata.ld"
cargo ndk --target arm64-v8a --target armeabi-v7a --target x86_64 --target x86 --platform 21 \
    --output-dir "$(realpath -m "${CARGO_TARGET_DIR:-target}")/android" \
    build --locked --profile ship -p magcomp-ffi --lib -Zbuild-std=std,panic_abort -Zbuild-std-features=panic-unwind
