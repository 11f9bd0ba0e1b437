#!/usr/bin/env bash
# The Android library on the host JVM: builds the real native library, then compiles, checks and tests the Kotlin side.
# `tests/kotlin.sh`, or with arguments for Maven. PROFILE=ship takes the library as phones get it, which builds longer.
# Needs Rust, a JDK 17 or newer and Maven.
set -euo pipefail
cd "$(dirname "$0")/.."
for tool in cargo java mvn; do
    command -v $tool >/dev/null || { echo "kotlin: $tool is missing; install Rust, a JDK 17 or newer and Maven" >&2; exit 1; }
done
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
profile=${PROFILE:-release}
cargo build --quiet --locked --profile "$profile" -p magcomp-ffi --features test-hooks
cargo build --quiet --locked --profile "$profile" -p magcomp-ffi --features test-hooks --example expected
mkdir -p "$target/kotlin"
"$target/$profile/examples/expected" tests/recordings/broad_34_attached_magnet_3cm.csv.gz tests/vectors >"$target/kotlin/expected.txt"
mvn --batch-mode --no-transfer-progress -Dorg.slf4j.simpleLogger.defaultLogLevel=warn --file android/pom.xml "${@:-verify}" -pl '!aar' \
    -Dnative.dir="$target/$profile" -Drust.expected="$target/kotlin/expected.txt"
