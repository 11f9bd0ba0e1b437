#!/usr/bin/env bash
# The core without `std`: builds it for a bare Cortex-M4 (thumbv7em-none-eabihf), where rustup has that target, and runs tests/bare on an emulated board:
# every reading must have the bits of this machine's. Prints what memory a compensator takes there, which must not be more than below. `tests/bare.sh`,
# also `tests/run.sh bare`.
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
cat "$target.there.txt"
# bytes of a compensator with its heap, and of the stack: ours have a bank of the magnetometer alone, also where a gyroscope leaves it idle
awk '$2 == "memory" {
    most = $1 == "Windowed:" ? 150000 : 480000
    if ($3 + 0 > most || $3 + 0 < 1000 || $NF + 0 > 200000) { bad = 1; print "bare: more than " most " bytes, or 200000 of the stack: " $0 > "/dev/stderr" }
} END { exit bad }' "$target.there.txt"
# each method has learned, and reads the same
! grep -q 'b_x None' "$target.here.txt" || { echo "bare: a method has learned nothing" >&2; exit 1; }
grep readings "$target.there.txt" | diff "$target.here.txt" - || { echo "bare: other readings than on this machine" >&2; exit 1; }
