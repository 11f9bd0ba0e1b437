#!/usr/bin/env bash
# Builds the page: one file, web/dist/magcomp.html, or the file that is named. `web/build.sh [PAGE.html]`.
# Where cargo's Rust has the target wasm32-unknown-unknown, or rustup brings it, that builds it. Else Debian's Rust
# builds the target's standard library from its source; as root that is installed (tests/need.sh).
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
page=$(realpath -m "${1:-web/dist/magcomp.html}")
need web python3:python3
triple=wasm32-unknown-unknown
CARGO_TARGET_DIR=$(realpath -m "${CARGO_TARGET_DIR:-target}")/web
export CARGO_TARGET_DIR
need_std web $triple
if [ ${#std[@]} -gt 0 ]; then
    need_llvm web wasm-ld:lld
    export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=wasm-ld$llvm
fi
cargo build --quiet --locked --release --manifest-path web/Cargo.toml --target $triple ${std[@]+"${std[@]}"}
web/assemble.py "$CARGO_TARGET_DIR/$triple/release/magcomp_web.wasm" "$page"
