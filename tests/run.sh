#!/usr/bin/env bash
# Every test. `tests/run.sh` runs all parts, `tests/run.sh rust bindings` some. A part that can't run fails and says what
# is missing. `mobile` installs a second compiler where it may.
set -euo pipefail
cd "$(dirname "$0")/.."
parts=(rust bindings kotlin swift mobile aar xcframework)

rust() {
    command -v cargo >/dev/null || { echo "rust: cargo is missing; install Rust 1.89 or newer" >&2; exit 1; }
    tests/versions.sh
    cargo fmt --all --check
    # the generator of the bindings is 5 lines on a large library: `bindings` builds it
    local all=(--workspace --exclude uniffi-bindgen --locked)
    cargo clippy "${all[@]}" --all-targets -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc "${all[@]}" --no-deps
    cargo test "${all[@]}"
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
for part in "${@:-${parts[@]}}"; do
    case " ${parts[*]} " in
        *" $part "*) ;;
        *) echo "unknown part '$part'; parts are: ${parts[*]}" >&2; exit 2 ;;
    esac
    echo "== $part"
    begin=$SECONDS
    "$part"
    echo "== $part passed in $((SECONDS - begin)) s"
done
echo "== all passed in $SECONDS s"
