#!/usr/bin/env bash
# The Android library on the host JVM: builds the real native library, then compiles, checks and tests the Kotlin side.
# `tests/kotlin.sh`, or with arguments for Maven. PROFILE=ship takes the library as phones get it, which builds longer.
# Needs Rust, a JDK 17 or newer and Maven.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
need kotlin "${rust_tools[@]}" "${java_tools[@]}"
. tests/native.sh
expected "$target/kotlin/expected.txt"
mvn --batch-mode --no-transfer-progress -Dorg.slf4j.simpleLogger.defaultLogLevel=warn --file android/pom.xml "${@:-verify}" -pl '!aar' \
    -Dnative.dir="$native" -Drust.expected="$target/kotlin/expected.txt"
