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
# to test Swift nobody needs the lab with Parquet and Arrow
packages=(--package magcomp-ffi --features magcomp-ffi/test-hooks)
. tests/native.sh
expected "$target/swift/expected.txt"
gzip -dc tests/recordings/broad_34_attached_magnet_3cm.csv.gz >"$target/swift/recording.csv"
gzip -dc tests/recordings/broad_01_slow_rotation_A.csv.gz >"$target/swift/slow_rotation.csv"

export MAGCOMP_NATIVE=$native MAGCOMP_EXPECTED=$target/swift
# the package's own warnings are errors, and what it builds stays out of its folder
options=(--package-path ios --scratch-path "$target/swift/build" -Xswiftc -warnings-as-errors)
# what the build has left of the modules
modules() { dirname "$(find "$target/swift/build" -path '*/debug/Modules/Magcomp.swiftmodule' | head -n 1)"; }
# documentation MODULE [CATALOG]
documentation() {
    rm -rf "$target/swift/symbols"
    mkdir -p "$target/swift/symbols/$1" "$target/swift/documentation"
    swift_tool swift-symbolgraph-extract -module-name "$1" -I "$(modules)" -target "$(swift_tool swiftc -print-target-info |
        python3 -c 'import json, sys; print(json.load(sys.stdin)["target"]["triple"])')" -output-dir "$target/swift/symbols" \
        -Xcc "-fmodule-map-file=$PWD/ios/Sources/MagcompFFI/module.modulemap"
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
    # without a release and without what a Mac builds, the package manager names what is missing
    if (unset MAGCOMP_NATIVE; swift_run package --package-path "$work/copy" resolve) >"$work/missing" 2>&1; then
        echo "swift: a missing framework is not noticed" >&2
        return 1
    fi
    grep -q "target/ios/MagcompFFI.xcframework' does not contain a binary artifact" "$work/missing" || { cat "$work/missing" >&2; return 1; }
    CARGO_TARGET_DIR=$work/target "$work/copy/ios/build-xcframework.sh" --pack "$url" >/dev/null
    [ "$(diff Package.swift "$work/copy/Package.swift" | grep -c '^>')" = 1 ]
    (unset MAGCOMP_NATIVE; swift_run package --package-path "$work/copy" dump-package) >"$work/dump.json"
    python3 - "$work/dump.json" "$url" "$(sha256sum "$work/target/ios/MagcompFFI.xcframework.zip" | cut -d' ' -f1)" <<'PYTHON'
import json, sys

package = json.load(open(sys.argv[1]))
native = next(target for target in package["targets"] if target["name"] == "MagcompFFI")
assert (native["type"], native["url"], native["checksum"]) == ("binary", *sys.argv[2:]), native
# an app gets no stand-in, no test and no flag that the package manager refuses in a dependency
assert {target["name"] for target in package["targets"]} == {"MagcompFFI", "Magcomp"}, package["targets"]
assert not [target for target in package["targets"] if target.get("settings")], package["targets"]
PYTHON
    echo "swift: the manifest of a release names its framework"
}

# What only iOS compiles, against the stand-ins: the library whole, the sample, the tutorial's views. A warning is an error.
as_for_ios() {
    local work=$target/swift/ios modules compile file
    modules=$(modules)
    rm -rf "$work"
    mkdir -p "$work/library" "$work/app"
    compile=(swift_tool swiftc -swift-version 6 -warnings-as-errors -wmo -emit-sil -o /dev/null -I "$modules" -parse-as-library
        -package-name magcomp -Xcc "-fmodule-map-file=$PWD/ios/Sources/MagcompFFI/module.modulemap")
    for file in ios/Sources/Magcomp/*.swift; do sed 's/os(iOS)/os(Linux)/' "$file" >"$work/library/${file##*/}"; done
    "${compile[@]}" -module-name Magcomp "$work"/library/*.swift
    # a preview is a macro of Xcode's
    for file in ios/Sample/Compass.swiftpm/C*.swift; do sed '/^#Preview/,$d' "$file" >"$work/app/${file##*/}"; done
    "${compile[@]}" -module-name App "$work"/app/*.swift
    for file in ios/Sources/Magcomp/Magcomp.docc/Resources/CompassView-*.swift; do "${compile[@]}" -module-name View "$file"; done
    swift_tool swiftc -frontend -parse ios/Sample/Compass.swiftpm/Package.swift ios/Sources/Magcomp/Magcomp.docc/Resources/App-Package.swift
    echo "swift: the library's iOS part, the sample and the tutorial compile against the stand-ins of SwiftUI and UIKit"
}

case "${1:-}" in
    "")
        swift_tool swift-format lint --strict -r --configuration .swift-format ios/Sources ios/Tests ios/Adapters ios/Sample Package.swift ios/Package.swift
        swift_run build "${options[@]}"
        # one test at a time: some measure memory
        swift_run test "${options[@]}" --no-parallel
        # an app's own package by path: no reading lost, the numbers of Rust
        grep '^reading ' "$target/swift/expected.txt" | cut -d' ' -f1-10 >"$target/swift/of-rust.txt"
        swift_run run --package-path ios/Tests/Consumer --scratch-path "$target/swift/consumer" Consumer \
            "$target/swift/recording.csv" >"$target/swift/of-consumer.txt"
        cmp "$target/swift/of-rust.txt" "$target/swift/of-consumer.txt"
        echo "swift: a package of its own reads $(wc -l <"$target/swift/of-consumer.txt") readings, those of Rust"
        # what an app gets of a release, and what it is told where there is none
        release_manifest
        # the documentation's links lead somewhere, and every public symbol has a page
        documentation Magcomp ios/Sources/Magcomp/Magcomp.docc
        tests/api.sh swift
        as_for_ios
        ;;
    benchmark) swift_run run -c release "${options[@]}" Benchmark "$target/swift/recording.csv" ;;
    test) swift_run test "${options[@]}" --no-parallel "${@:2}" ;;
    *) swift_run "$1" "${options[@]}" "${@:2}" ;;
esac
