#!/usr/bin/env bash
# The golden readings (tests/host/readings.rs) on other processors and libraries: each must have the bits of this machine; how far apart, where not.
# `tests/determinism.sh [no-fma|musl|i686|aarch64|wasm]...`, by name before a release; all without a name.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
target=$PWD/${CARGO_TARGET_DIR:-target}
case "${CARGO_TARGET_DIR-}" in /*) target=$CARGO_TARGET_DIR ;; esac
mkdir -p "$target/readings"

readings() { # NAME ARGUMENT... -> writes the readings of that target
    local name=$1
    shift
    MAGCOMP_WRITE_READINGS=$target/readings/$name.txt cargo test --locked --quiet --release -p magcomp-tests --test readings "$@" >&2
}
target_of_rust() { # TARGET: its std, where rustup brings it
    rustc --print target-libdir --target "$1" | xargs -I{} test -d {} || rustup target add "$1"
}

of_no_fma() { # a processor of 2008, without AVX and fused multiplication, of which libraries could make use
    need determinism qemu-x86_64:qemu-user
    CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUNNER='qemu-x86_64 -cpu Nehalem' readings no-fma
}
of_musl() {
    target_of_rust x86_64-unknown-linux-musl
    readings musl --target x86_64-unknown-linux-musl
}
of_i686() {
    need determinism i686-linux-gnu-gcc:gcc-i686-linux-gnu '/usr/i686-linux-gnu/lib/libc.a:libc6-dev-i386-cross'
    target_of_rust i686-unknown-linux-gnu
    # static, since this machine may lack the libraries
    CARGO_TARGET_I686_UNKNOWN_LINUX_GNU_LINKER=i686-linux-gnu-gcc CARGO_TARGET_I686_UNKNOWN_LINUX_GNU_RUSTFLAGS='-C target-feature=+crt-static' \
        readings i686 --target i686-unknown-linux-gnu
}
of_aarch64() {
    need determinism aarch64-linux-gnu-gcc:gcc-aarch64-linux-gnu '/usr/aarch64-linux-gnu/lib/libc.a:libc6-dev-arm64-cross' qemu-aarch64:qemu-user
    target_of_rust aarch64-unknown-linux-gnu
    CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc \
        CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER='qemu-aarch64 -L /usr/aarch64-linux-gnu' \
        readings aarch64 --target aarch64-unknown-linux-gnu
}
of_wasm() {
    need determinism node:nodejs
    target_of_rust wasm32-wasip1
    CARGO_TARGET_WASM32_WASIP1_RUNNER="node --no-warnings $PWD/tests/wasi.mjs" readings wasm --target wasm32-wasip1
}

need determinism "${rust_tools[@]}" python3:python3
readings here
differ=0
for name in "${@:-no-fma musl i686 aarch64 wasm}"; do
    for one in $name; do
        case "$one" in
            no-fma | musl | i686 | aarch64 | wasm) "of_${one/-/_}" || differ=1 ;;
            *) echo "tests/determinism.sh [no-fma|musl|i686|aarch64|wasm]..." >&2; exit 2 ;;
        esac
        echo "$one: $(tests/same_bits.py "$target/readings/here.txt" "$target/readings/$one.txt")" || differ=1
    done
done
exit $differ
