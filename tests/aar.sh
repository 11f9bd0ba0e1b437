#!/usr/bin/env bash
# Packs the AAR with its POM, opens it again and checks every part. Uses the Android libraries of tests/mobile.sh: a structure
# check, not for shipping. Then stages it with a magcomp-host (tests/staging.sh). `tests/aar.sh` packs arm64-v8a alone; `tests/aar.sh ABI...` others,
# `tests/aar.sh all` all four.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
need aar "${java_tools[@]}" unzip:unzip
[ "$*" = all ] && set -- arm64-v8a armeabi-v7a x86_64 x86
[ $# -gt 0 ] || set -- arm64-v8a
tests/mobile.sh "$@"
need aar "${rust_tools[@]}"
. tests/native.sh
# these and no others, which may be older
rm -rf "$target/aar"
for abi in "$@"; do
    install -D "$target/android/$abi/libmagcomp_ffi.so" "$target/aar/$abi/libmagcomp_ffi.so"
done
rm -rf android/host/target
mvn --batch-mode --no-transfer-progress -Dorg.slf4j.simpleLogger.defaultLogLevel=warn --file android/pom.xml verify -pl aar,host -am \
    -Dandroid.libraries="$target/aar" -Dandroid.abis="$*" -Dnative.dir="$native" -Dtest=AarTest -Dsurefire.failIfNoSpecifiedTests=false \
    -Dlibrary.test.skip=true -Dlibrary.kdoc.skip=true
echo "aar: $(cd android/aar/target && ls *.aar), for $* alone"
unzip -l android/aar/target/*.aar
tests/staging.sh
