#!/usr/bin/env bash
# The Android library on the host JVM: builds the real native library, then compiles, checks and tests the Kotlin side.
# `tests/kotlin.sh`, or with arguments for Maven. Needs Rust, a JDK 17 or newer and Maven.
set -euo pipefail
cd "$(dirname "$0")/.."
for tool in cargo java mvn; do
    command -v $tool >/dev/null || { echo "kotlin: $tool is missing; install Rust, a JDK 17 or newer and Maven" >&2; exit 1; }
done
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
cargo build --quiet --locked --profile ship -p magcomp-ffi --features test-hooks
cargo build --quiet --locked --profile ship -p magcomp-ffi --features test-hooks --example expected
mkdir -p "$target/kotlin"
"$target/ship/examples/expected" tests/recordings/broad_34_attached_magnet_3cm.csv.gz tests/vectors >"$target/kotlin/expected.txt"
mvn --batch-mode --no-transfer-progress -Dorg.slf4j.simpleLogger.defaultLogLevel=warn --file android/pom.xml "${@:-verify}" -pl '!aar' \
    -Dnative.dir="$target/ship" -Drust.expected="$target/kotlin/expected.txt"
