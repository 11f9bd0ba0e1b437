#!/usr/bin/env bash
# Packs the AAR with its POM, opens it again and checks every part. Uses the Android libraries of tests/mobile.sh, which
# it runs when they are missing: a structure check, not for shipping.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v mvn >/dev/null || { echo "aar: mvn is missing; install Maven and a JDK 17 or newer" >&2; exit 1; }
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
[ -f "$target/android/x86_64/libmagcomp_ffi.so" ] || tests/mobile.sh
mvn --batch-mode --no-transfer-progress -Dorg.slf4j.simpleLogger.defaultLogLevel=warn --file android/pom.xml verify -pl aar -am \
    -Dandroid.libraries="$target/android" -Dtest=AarTest -Dsurefire.failIfNoSpecifiedTests=false
echo "aar: $(cd android/aar/target && ls *.aar)"
unzip -l android/aar/target/*.aar
