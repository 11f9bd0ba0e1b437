#!/usr/bin/env bash
# Packs the AAR with its POM, opens it again and checks every part. Uses the Android libraries of tests/mobile.sh, which
# builds those that are missing: a structure check, not for shipping.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v mvn >/dev/null || { echo "aar: mvn is missing; install Maven and a JDK 17 or newer" >&2; exit 1; }
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
for abi in arm64-v8a armeabi-v7a x86_64; do
    [ -f "$target/android/$abi/libmagcomp_ffi.so" ] || tests/mobile.sh "$abi"
done
mvn --batch-mode --no-transfer-progress -Dorg.slf4j.simpleLogger.defaultLogLevel=warn --file android/pom.xml verify -pl aar -am \
    -Dandroid.libraries="$target/android" -Dtest=AarTest -Dsurefire.failIfNoSpecifiedTests=false
echo "aar: $(cd android/aar/target && ls *.aar)"
unzip -l android/aar/target/*.aar
