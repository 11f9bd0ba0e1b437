#!/usr/bin/env bash
# The core without `std`: builds it for a bare Cortex-M4 (thumbv7em-none-eabihf), where rustup has that target, and runs tests/bare on an emulated board:
# every reading must have the bits of this machine's. Prints what memory a compensator takes there, docs/dev/COST.md's table, which must be as below.
# `tests/bare.sh`, also `tests/run.sh bare`.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
need bare "${rust_tools[@]}" qemu-system-arm:qemu-system-arm
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")/bare
bare=thumbv7em-none-eabihf
[ -d "$(rustc --print target-libdir --target $bare)" ] || rustup --quiet target add $bare ||
    { echo "bare: missing: Rust's core and alloc for $bare; rustup target add $bare" >&2; exit 1; }
cd tests/bare
CARGO_TARGET_DIR=$target cargo run --quiet --locked --release --features std >"$target.here.txt"
CARGO_TARGET_DIR=$target CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUSTFLAGS='-C link-arg=-Tlink.x' \
    CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUNNER='qemu-system-arm -cpu cortex-m4 -machine mps2-an386 -nographic -semihosting-config enable=on,target=native -kernel' \
    cargo run --quiet --locked --release --target $bare >"$target.there.txt"
grep readings "$target.there.txt"
# bytes of a compensator with its heap, and of the stack, both at most so many, and not much less, so that the limits stay near
awk 'BEGIN {
    split("Auto 440000 80000 Aided 65536 80000 Adaptive 400000 80000 Windowed 100000 72000", limits)
    for (k = 1; k in limits; k += 3) { memory[limits[k]] = limits[k + 1]; stack[limits[k]] = limits[k + 2] }
    print "| method | itself | heap | together | stack at most |\n|---|---|---|---|---|"
}
$2 == "memory" {
    method = substr($1, 1, length($1) - 1)
    if ($3 > memory[method] || $3 < 0.8 * memory[method] || $NF > stack[method] || $NF < 0.5 * stack[method]) {
        bad = 1; print "bare: not near " memory[method] " bytes and " stack[method] " of the stack: " $0 > "/dev/stderr"
    }
    printf "| `%s` | %d | %d | %d | %d |\n", method, $5, $10, $3, $NF
} END { exit bad }' "$target.there.txt"
# each method has learned, and reads the same
! grep -q 'b_x None' "$target.here.txt" || { echo "bare: a method has learned nothing" >&2; exit 1; }
grep readings "$target.there.txt" | diff "$target.here.txt" - || { echo "bare: other readings than on this machine" >&2; exit 1; }
