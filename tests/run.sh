#!/usr/bin/env bash
# Every test. `tests/run.sh` runs all parts, `tests/run.sh rust bindings` some. Needs Rust 1.89 or newer; what else a part needs
# it installs as root on Debian (tests/need.sh), or it fails and names what is missing. Mobile libraries are built for one
# architecture each; tests/mobile.sh, tests/aar.sh and tests/xcframework.sh build all with the argument `all`.
set -euo pipefail
cd "$(dirname "$0")/.."
parts=(rust bindings kotlin swift python c web mobile aar xcframework)

rust() {
    tests/need-test.sh
    . tests/need.sh
    need rust "${rust_tools[@]}" python3:python3
    tests/versions.sh
    tests/circles.py
    tests/choices-test.py
    tests/choices.py
    tests/privacy.py
    tests/notices.py --check
    tests/figures.py
    if grep -rnIE --exclude-dir=.git --exclude-dir=target '^(<{7}|>{7}|={7}$)' .; then echo "markers of a merge are left" >&2; exit 1; fi
    cargo fmt --all --check
    cargo clippy --locked "${workspace[@]}" --all-targets -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --locked "${workspace[@]}" --no-deps --lib --example expected
    cargo test --locked "${workspace[@]}"
    # the lab as it is usually built, without the importers that bring large dependencies
    cargo clippy --locked -p magcomp-lab --all-targets -- -D warnings
    cargo test --locked -p magcomp-lab --test lean
    # the core alone, as others take it: with the features that it asks for itself, and its enums may grow
    cargo clippy --locked -p magcomp -- -D warnings
}

bindings() { bindings/generate.sh --check; }
kotlin() { tests/kotlin.sh; }
swift() { tests/swift.sh; }
python() { tests/python.sh; }
c() { tests/c.sh; }
web() { tests/web.sh; }
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
