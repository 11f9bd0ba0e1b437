#!/usr/bin/env bash
# The Swift package on Linux: builds the real native library, then compiles and tests the Swift side, its documentation,
# its format and the grammar of the sample. `tests/swift.sh`, or with arguments for `swift`, for instance `tests/swift.sh test --filter Facts`;
# `tests/swift.sh benchmark` prints what a push costs. PROFILE=ship takes the library as phones get it, which builds longer.
# Needs Rust, and Swift 6 on PATH, or root that may mount, to make a Debian root with Swift in a cache folder: MAGCOMP_SWIFT_ROOT,
# by default ~/.cache/magcomp/swift (3 GB, a few minutes; deleting it is safe when nothing runs in it).
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
need swift "${rust_tools[@]}" python3:python3 zip:zip
[ "${1:-}" != benchmark ] || PROFILE=${PROFILE:-ship}
# first, since it may end the script
. tests/swift-toolchain.sh
. tests/native.sh
expected "$target/swift/expected.txt"
gzip -dc tests/recordings/broad_34_attached_magnet_3cm.csv.gz >"$target/swift/recording.csv"
gzip -dc tests/recordings/broad_01_slow_rotation_A.csv.gz >"$target/swift/slow_rotation.csv"

export MAGCOMP_FRAMEWORKS=stand-in MAGCOMP_NATIVE=$native MAGCOMP_EXPECTED=$target/swift
# the package's own warnings are errors, and what it builds stays out of its folder
mkdir -p "$target/swift/symbols"
options=(--scratch-path "$target/swift/build" -Xswiftc -warnings-as-errors)
options+=(-Xswiftc -emit-symbol-graph -Xswiftc -emit-symbol-graph-dir -Xswiftc "$target/swift/symbols")
# documentation MODULE [CATALOG]
documentation() {
    mkdir -p "$target/swift/symbols/$1" "$target/swift/documentation"
    cp "$target/swift/symbols/$1.symbols.json" "$target/swift/symbols/$1/"
    swift_tool docc convert "${@:2}" --warnings-as-errors --fallback-display-name "$1" --fallback-bundle-identifier "org.magcomp.$1" \
        --additional-symbol-graph-dir "$target/swift/symbols/$1" --output-path "$target/swift/documentation/$1"
    python3 - "$1" "$target/swift/symbols/$1" "$target/swift/documentation/$1" <<'PYTHON'
import json, pathlib, sys

module, symbols, pages = sys.argv[1], *map(pathlib.Path, sys.argv[2:])
there = {json.loads(page.read_text())["metadata"].get("externalID") for page in pages.glob("data/documentation/**/*.json")}
public, missing, mute = 0, [], []
for graph in (json.loads(file.read_text()) for file in symbols.glob("*.symbols.json")):
    for symbol in graph["symbols"]:
        # what the compiler writes for a protocol has the protocol's page
        if symbol["accessLevel"] not in ("public", "open") or "::SYNTHESIZED::" in symbol["identifier"]["precise"]:
            continue
        public += 1
        name = ".".join(symbol["pathComponents"])
        if symbol["identifier"]["precise"] not in there:
            missing.append(name)
        if len(symbol["pathComponents"]) == 1 and symbol["kind"]["identifier"] != "swift.extension" and "docComment" not in symbol:
            mute.append(name)
if missing or mute:
    sys.exit(f"swift: {module}: without a page: {missing}; without a word: {mute}")
print(f"swift: {module}: {public} public symbols, each with a page")
PYTHON
}

# the manifest's branch that ships, with a framework that is none
release_manifest() {
    local work=$target/swift/release url='https://example.com/MagcompFFI.xcframework.zip?a=1&b=2'
    rm -rf "$work"
    mkdir -p "$work/copy/ios" "$work/copy/tests" "$work/target/ios/MagcompFFI.xcframework"
    cp Package.swift "$work/copy/"
    cp ios/build-xcframework.sh "$work/copy/ios/"
    cp tests/need.sh "$work/copy/tests/"
    echo none >"$work/target/ios/MagcompFFI.xcframework/Info.plist"
    if MAGCOMP_RELEASE=1 swift_run package --package-path "$work/copy" dump-package >"$work/missing" 2>&1; then
        echo "swift: a missing framework is not noticed" >&2
        return 1
    fi
    grep -q 'magcomp: .*target/ios/MagcompFFI.xcframework is missing.*ios/build-xcframework.sh' "$work/missing" ||
        { cat "$work/missing" >&2; return 1; }
    CARGO_TARGET_DIR=$work/target "$work/copy/ios/build-xcframework.sh" --pack "$url" >/dev/null
    [ "$(diff Package.swift "$work/copy/Package.swift" | grep -c '^>')" = 1 ]
    MAGCOMP_RELEASE=1 swift_run package --package-path "$work/copy" dump-package >"$work/dump.json"
    python3 - "$work/dump.json" "$url" "$(sha256sum "$work/target/ios/MagcompFFI.xcframework.zip" | cut -d' ' -f1)" <<'PYTHON'
import json, sys

package = json.load(open(sys.argv[1]))
native = next(target for target in package["targets"] if target["name"] == "MagcompFFI")
assert (native["type"], native["url"], native["checksum"]) == ("binary", *sys.argv[2:]), native
# an app gets no stand-in, no test and no flag that the package manager refuses in a dependency
assert {target["name"] for target in package["targets"]} == {"MagcompFFI", "MagcompBindings", "Magcomp"}, package["targets"]
assert not [target for target in package["targets"] if target.get("settings")], package["targets"]
PYTHON
    echo "swift: the manifest of a release names its framework"
}

case "${1:-}" in
    "")
        swift_tool swift-format lint --strict -r --configuration .swift-format ios/Sources ios/Tests ios/Adapters ios/Sample Package.swift
        swift_run build "${options[@]}"
        # one test at a time: some measure memory
        swift_run test "${options[@]}" --no-parallel
        # an app's own package by path: no reading lost, the numbers of the command
        cargo build --quiet --locked --profile "$profile" "${workspace[@]}" --bin magcomp --example expected
        "$native/magcomp" replay --axis auto \
            tests/recordings/broad_34_attached_magnet_3cm.csv.gz --output "$target/swift/replay.csv" >/dev/null
        cut -d, -f2-10,14 "$target/swift/replay.csv" | tail -n +2 >"$target/swift/of-replay.csv"
        swift_run run --package-path ios/Tests/Consumer --scratch-path "$target/swift/consumer" Consumer \
            "$target/swift/recording.csv" >"$target/swift/of-consumer.csv"
        cmp "$target/swift/of-replay.csv" "$target/swift/of-consumer.csv"
        echo "swift: a package of its own reads $(wc -l <"$target/swift/of-consumer.csv") readings, those of magcomp replay"
        # what an app gets of a release, and what it is told where there is none
        release_manifest
        # the documentation's links lead somewhere, and every public symbol has a page
        documentation Magcomp ios/Sources/Magcomp/Magcomp.docc
        documentation MagcompBindings
        tests/api.sh swift
        # the sample and the tutorial's files need SwiftUI: their grammar at least
        swift_tool swiftc -frontend -parse ios/Sample/Compass.swiftpm/*.swift
        for file in ios/Sources/Magcomp/Magcomp.docc/Resources/*.swift; do swift_tool swiftc -frontend -parse "$file"; done
        ;;
    benchmark) swift_run run -c release "${options[@]}" Benchmark "$target/swift/recording.csv" ;;
    *) swift_run "$1" "${options[@]}" "${@:2}" ;;
esac
