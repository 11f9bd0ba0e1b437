#!/usr/bin/env bash
# The Android library on the host JVM: builds the real native library, then compiles, checks and tests the Kotlin side, installs
# magcomp-host in the local Maven repository, and tests it as an app would, also shrunk (android/host/outsider).
# `tests/kotlin.sh`, or with arguments for Maven, which then is all that runs. PROFILE=ship takes the library as phones get it, which builds longer.
# Needs Rust, a JDK 17 or newer and Maven.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
# the drawn sample: what Skia loads
need kotlin "${rust_tools[@]}" "${java_tools[@]}" '/usr/lib/*/libGL.so.1:libgl1' '/usr/lib/*/libX11.so.6:libx11-6' \
    '/usr/lib/*/libfontconfig.so.1:libfontconfig1' '/usr/lib/jvm/*/lib/libjawt.so:default-jre'
. tests/native.sh
expected "$target/kotlin/expected.txt"
tests/gradle.sh
mvn() { command mvn --batch-mode --no-transfer-progress -Dorg.slf4j.simpleLogger.defaultLogLevel=warn "$@"; }
# or else classes of sources that are gone get into the jars
rm -rf android/{bindings,library,compose,sample}/target/{classes,test-classes} android/host/target
mvn --file android/pom.xml "${@:-verify}" -pl '!aar' -Dnative.dir="$native" -Drust.expected="$target/kotlin/expected.txt"
[ $# -eq 0 ] || exit 0
host=android/host/target
mvn install:install-file -Dfile="$(ls $host/magcomp-host-*.jar)" -DpomFile=$host/consumer.pom
mvn --file android/host/outsider/pom.xml verify
