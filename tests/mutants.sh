#!/usr/bin/env bash
# Breaks the sources on purpose, one small patch at a time in a copy, and expects the tests to fail. Run by name before a release; no part of
# tests/run.sh. `tests/mutants.sh kotlin` applies tests/mutants/kotlin/patches.txt, `tests/mutants.sh swift`
# tests/mutants/swift/patches.txt; with a WORD (a regular expression) those that have it. `tests/mutants.sh rust [SHARE [WORD [PATH...]]]` compiles all mutants
# of the core's files PATH into one library and asks the tests about the share, 0/8 of them by default, that has WORD in its names: tests/mutants/rust.md.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh

of_kotlin() { # [WORD]
    need mutants "${rust_tools[@]}" "${java_tools[@]}" '/usr/lib/*/libGL.so.1:libgl1' '/usr/lib/*/libX11.so.6:libx11-6' \
        '/usr/lib/*/libfontconfig.so.1:libfontconfig1' '/usr/lib/jvm/*/lib/libjawt.so:default-jre'
    . tests/native.sh
    expected "$target/kotlin/expected.txt"
    rm -rf android/{bindings,library,compose,sample}/target/{classes,test-classes}
    mvn=(mvn --batch-mode --no-transfer-progress -Dorg.slf4j.simpleLogger.defaultLogLevel=warn --file android/pom.xml)
    "${mvn[@]}" test-compile org.apache.maven.plugins:maven-dependency-plugin:3.8.1:build-classpath -Dmdep.outputFile=target/classpath.txt \
        -Dlibrary.kdoc.skip=true -Dnative.dir="$native" -pl bindings,library,compose,sample
    local repository kotlin platform compiler="" name
    repository=$(grep -o '[^:]*/org/junit/platform/junit-platform-engine/' android/library/target/classpath.txt | head -n 1)
    repository=${repository%/org/junit/*}
    kotlin=$(sed -n 's#.*<kotlin.version>\(.*\)</kotlin.version>.*#\1#p' android/pom.xml)
    platform=$(grep -o 'junit-platform-engine-[0-9.]*[0-9]' android/library/target/classpath.txt | head -n 1)
    platform=${platform##*-}
    # what Maven's plugin for tests brought, on machines where it has run
    [ -f "$repository/org/junit/platform/junit-platform-launcher/$platform/junit-platform-launcher-$platform.jar" ] ||
        "${mvn[@]}" --quiet -N dependency:get -Dartifact="org.junit.platform:junit-platform-launcher:$platform"
    local launcher=$repository/org/junit/platform/junit-platform-launcher/$platform/junit-platform-launcher-$platform.jar
    for name in kotlin-compiler-embeddable kotlin-stdlib kotlin-script-runtime kotlin-daemon-embeddable kotlin-reflect; do
        compiler+=:$(ls "$repository/org/jetbrains/kotlin/$name"/*/"$name"-[0-9]*.jar | grep -v sources | sort -V | tail -n 1)
    done
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
    local tests
    tests=$(cat android/library/target/classpath.txt)
    javac -d "$work" -cp "$compiler:$launcher:$tests" tests/mutants/kotlin/Mutants.java
    java -Xmx1g -Dkotlin.environment.keepalive=true -Drepository.root="$PWD" -Dwork="$work" -Dpatches=tests/mutants/kotlin/patches.txt \
        -Drunner.path="$work:$launcher" -Drust.expected="$target/kotlin/expected.txt" -Djava.library.path="$native" -Djna.library.path="$native" \
        -Dcompose.plugin="$repository/org/jetbrains/kotlin/kotlin-compose-compiler-plugin-embeddable/$kotlin/kotlin-compose-compiler-plugin-embeddable-$kotlin.jar" \
        -cp "$work$compiler:$launcher:$tests" Mutants "$@"
}

of_swift() { # [WORD]
    need mutants "${rust_tools[@]}" git:git python3:python3
    . tests/swift-toolchain.sh
    # as tests/swift.sh
    local packages=(--package magcomp-ffi --features magcomp-ffi/test-hooks)
    . tests/native.sh
    expected "$target/swift/expected.txt"
    gzip -dc tests/recordings/broad_34_attached_magnet_3cm.csv.gz >"$target/swift/recording.csv"
    gzip -dc tests/recordings/broad_01_slow_rotation_A.csv.gz >"$target/swift/slow_rotation.csv"
    local copy=$target/mutants/swift
    rm -rf "$copy"
    mkdir -p "$copy"
    git ls-files -z -- Package.swift README.md docs/FRAMEWORKS.md ios bindings/swift rust/magcomp-ffi/include tests/vectors \
        tests/recordings/broad_34_attached_magnet_3cm.csv.gz | xargs -0 cp --parents -t "$copy"
    # many tests wait in vain for what a patch has broken
    export MAGCOMP_NATIVE=$native MAGCOMP_EXPECTED=$target/swift MAGCOMP_LONGEST_S=30
    # the tests run within the toolchain's root: the script that breaks stays outside
    export -f swift_tool
    export swift_on_path swift_root target
    python3 tests/mutants/swift/run.py "$copy" tests/mutants/swift/patches.txt "${1:-.}" -- \
        bash -euc 'swift_tool swift "$@" --package-path ios --scratch-path "$target/mutants/build"' mutants
}

of_rust() { # [SHARE [WORD [PATH...]]]
    need mutants "${rust_tools[@]}" git:git
    local target
    target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
    cargo build --quiet --release --manifest-path tests/mutants/rust/Cargo.toml --target-dir "$target/mutants/tool"
    CARGO_TARGET_DIR=$target "$target/mutants/tool/release/magcomp-mutants" "$target/mutants/rust" "${1:-0/8}" "${2-}" "${@:3}"
}

case "${1-}" in
    # not named as the tools that they call
    kotlin | swift | rust) "of_$1" "${@:2}" ;;
    *) echo "tests/mutants.sh kotlin|swift [WORD], or rust [SHARE [WORD [PATH...]]]" >&2; exit 2 ;;
esac
