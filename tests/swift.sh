#!/usr/bin/env bash
# The Swift package on Linux: builds the real native library, then compiles and tests the Swift side, its documentation,
# its format and the grammar of the sample. `tests/swift.sh`, or with arguments for `swift`, for instance `tests/swift.sh test --filter Facts`;
# `tests/swift.sh benchmark` prints what a push costs. PROFILE=ship takes the library as phones get it, which builds longer.
# Needs Rust, and Swift 6 on PATH, or root that may mount, to make a Debian root with Swift in a cache folder: MAGCOMP_SWIFT_ROOT,
# by default ~/.cache/magcomp/swift (3 GB, a few minutes; deleting it is safe when nothing runs in it).
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
need swift "${rust_tools[@]}"
[ "${1:-}" != benchmark ] || PROFILE=${PROFILE:-ship}
# first, since it may end the script
. tests/swift-toolchain.sh
. tests/native.sh
expected "$target/swift/expected.txt"
gzip -dc tests/recordings/broad_34_attached_magnet_3cm.csv.gz >"$target/swift/recording.csv"
gzip -dc tests/recordings/broad_01_slow_rotation_A.csv.gz >"$target/swift/slow_rotation.csv"

export MAGCOMP_FRAMEWORKS=stand-in MAGCOMP_NATIVE=$native MAGCOMP_EXPECTED=$target/swift
# the package's own warnings are errors, and what it builds stays out of its folder
mkdir -p "$target/swift/symbols/Magcomp"
options=(--scratch-path "$target/swift/build" -Xswiftc -warnings-as-errors)
options+=(-Xswiftc -emit-symbol-graph -Xswiftc -emit-symbol-graph-dir -Xswiftc "$target/swift/symbols")
case "${1:-}" in
    "")
        swift_tool swift-format lint --strict -r --configuration .swift-format ios/Sources ios/Tests ios/Sample Package.swift
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
        # the documentation's links lead somewhere
        cp "$target/swift/symbols/"Magcomp.symbols.json "$target/swift/symbols/Magcomp/"
        swift_tool docc convert ios/Sources/Magcomp/Magcomp.docc --warnings-as-errors \
            --additional-symbol-graph-dir "$target/swift/symbols/Magcomp" --output-path "$target/swift/documentation"
        tests/api.sh swift
        # the sample and the tutorial's files need SwiftUI: their grammar at least
        swift_tool swiftc -frontend -parse ios/Sample/Compass.swiftpm/*.swift
        for file in ios/Sources/Magcomp/Magcomp.docc/Resources/*.swift; do swift_tool swiftc -frontend -parse "$file"; done
        ;;
    benchmark) swift_run run -c release "${options[@]}" Benchmark "$target/swift/recording.csv" ;;
    *) swift_run "$1" "${options[@]}" "${@:2}" ;;
esac
