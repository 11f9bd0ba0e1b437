#!/usr/bin/env bash
# Every test. `tests/run.sh` runs the first four parts, `tests/run.sh rust` one of them. A part that can't run fails.
# `tests/run.sh mobile aar xcframework` checks the mobile targets and the Android and iOS packages; it installs a second
# compiler.
set -euo pipefail
cd "$(dirname "$0")/.."
parts=(rust bindings kotlin swift mobile aar xcframework)
defaults=(rust bindings kotlin swift)

rust() {
    command -v cargo >/dev/null || { echo "rust: cargo is missing; install Rust 1.89 or newer" >&2; exit 1; }
    cargo fmt --all --check
    cargo clippy --workspace --all-targets --locked -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --locked
    cargo test --workspace --locked
    cargo build --release --locked
}

bindings() { bindings/generate.sh --check; }
kotlin() { tests/kotlin.sh; }
swift() { tests/swift.sh; }
mobile() { tests/mobile.sh; }
aar() { tests/aar.sh; }
xcframework() { tests/xcframework.sh; }

part=
trap 'status=$?; [ $status -eq 0 ] || echo "== ${part:-setup} FAILED" >&2' EXIT
for part in "${@:-${defaults[@]}}"; do
    case " ${parts[*]} " in
        *" $part "*) ;;
        *) echo "unknown part '$part'; parts are: ${parts[*]}" >&2; exit 2 ;;
    esac
    echo "== $part"
    "$part"
done
echo "== all parts passed"
