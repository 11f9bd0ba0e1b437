#!/usr/bin/env bash
# Every test. `tests/run.sh` runs all parts but `night`, `host` and `bare`, `tests/run.sh rust bindings` some. A part that failed does not end the others; a
# table at the end says how each went. Needs Rust 1.89 or newer; what else a part needs it installs as root on Debian (tests/need.sh), or it fails and
# names what is missing. Mobile libraries are built for one architecture each; tests/mobile.sh, tests/aar.sh and tests/xcframework.sh build all
# with the argument `all`.
set -euo pipefail
cd "$(dirname "$0")/.."

# Two lanes run beside each other: what compiles Rust for this machine, and what mostly waits for packages, a virtual machine or one linker.
# In a lane a part comes after what it needs: Kotlin and the AAR write the same folders.
lanes=("rust c python bindings web" "swift kotlin mobile aar xcframework" "host night bare")

rust() {
    tests/need-test.sh
    . tests/need.sh
    need rust "${rust_tools[@]}" "${rust_checks[@]}" python3:python3
    tests/versions.sh
    tests/circles.py
    tests/choices-test.py
    tests/choices.py
    tests/privacy.py
    tests/notices.py --check
    tests/figures.py
    if grep -rnIE --exclude-dir=.git --exclude-dir=target '^(<{7}|>{7}|={7}$)' .; then echo "markers of a merge are left" >&2; exit 1; fi
    cargo fmt --all --check
    # with the Python module, which `workspace` leaves out
    cargo clippy --locked --workspace --exclude uniffi-bindgen --features magcomp-ffi/test-hooks,magcomp-lab/formats --all-targets -- -D warnings
    # the core without `std`
    cargo clippy --locked -p magcomp --lib --no-default-features -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --locked "${workspace[@]}" --exclude magcomp-c --no-deps --lib --example expected
    cargo test --locked "${workspace[@]}"
    # the core alone, as others take it
    tests/packed.sh
}

# the Rust tests alone, on any system, as most build it
host() {
    . tests/need.sh
    need host "${rust_tools[@]}"
    cargo test --locked "${lean[@]}"
}

# what takes too long for each change: all runs of the statistical tests, the command without the large importers, the wheel as it ships, 100 MB in
# a browser, the libraries of all architectures as phones get them
night() {
    . tests/need.sh
    need night "${rust_tools[@]}"
    MAGCOMP_NIGHT=1 MAGCOMP_FUZZ=1000 cargo test --locked "${workspace[@]}" --lib --bins --tests -- --include-ignored
    cargo test --locked "${lean[@]}" --test lean --test import
    MAGCOMP_NIGHT=1 PROFILE=release tests/python.sh
    MAGCOMP_NIGHT=1 tests/web.sh
    PROFILE=ship tests/mobile.sh all
    PROFILE=ship tests/xcframework.sh all
}

bindings() { bindings/generate.sh --check; }
kotlin() { tests/kotlin.sh; }
swift() { tests/swift.sh; }
python() { tests/python.sh; }
c() { tests/c.sh; }
bare() { tests/bare.sh; }
web() { tests/web.sh; }
mobile() { tests/mobile.sh; }
aar() { tests/aar.sh; }
xcframework() { tests/xcframework.sh; }

# part NAME: in a shell of its own, where the first failure is the end
part() {
    local begin=$SECONDS status times_of=$work/$1.times
    echo "== $1"
    set +e
    (trap 'times >"$times_of"' EXIT; set -e; "$1")
    status=$?
    set -e
    [ $status -eq 0 ] && status=passed || status=FAILED
    echo "== $1 $status in $((SECONDS - begin)) s"
    # their second line: all that the part has waited for
    echo "$1 $status $((SECONDS - begin)) $(awk 'NR == 2 { split($1 $2, t, /[ms]/); printf "%d", t[1] * 60 + t[2] + t[3] * 60 + t[4] }' "$times_of")" \
        >>"$work/results"
}

wanted=()
[ $# -gt 0 ] || read -ra wanted <<<"${lanes[0]} ${lanes[1]}"
for name; do
    case " ${lanes[*]} " in
        *" $name "*) wanted+=("$name") ;;
        *) echo "unknown part '$name'; parts are: ${lanes[*]}" >&2; exit 2 ;;
    esac
done
of_lane() { # LANE: its parts that are wanted, in the lane's order
    local name
    for name in $1; do case " ${wanted[*]} " in *" $name "*) echo "$name" ;; esac; done
}
work=$(mktemp -d)
beside=
trap '[ -z "$beside" ] || kill -- "-$beside" 2>/dev/null || true; rm -rf "$work"' EXIT

# how long each part took here when it last passed
times=$(realpath -m "${CARGO_TARGET_DIR:-target}")/run-times
echo "== to do, with the seconds that it last took here:"
for lane in "${lanes[@]}"; do
    line=
    for name in $(of_lane "$lane"); do
        line+="${line:+, }$name $(sed -n "s/^$name passed \([0-9]*\) .*/\1/p" "$times" 2>/dev/null | grep . || echo "(not run yet)")"
    done
    [ -z "$line" ] || echo "   $line"
done

# the second lane in the background; what it says comes part by part
if [ -n "$(of_lane "${lanes[0]}")" ] && [ -n "$(of_lane "${lanes[1]}")" ]; then
    set -m # a process group of its own, which can be ended whole
    (
        set +m
        for name in $(of_lane "${lanes[1]}"); do
            part "$name" >"$work/$name.out" 2>&1
            cat "$work/$name.out"
        done
    ) &
    beside=$!
    set +m
fi
for name in $(of_lane "${lanes[0]}") $([ -n "$beside" ] || of_lane "${lanes[1]}") $(of_lane "${lanes[2]}"); do part "$name"; done
[ -z "$beside" ] || wait "$beside"
beside=

mkdir -p "${times%/*}"
sort -k1,1 -u <(grep ' passed ' "$work/results" || true) <(cat "$times" 2>/dev/null || true) >"$work/times"
mv "$work/times" "$times"
echo "== part, result, seconds, seconds of processor time"
column -t "$work/results" 2>/dev/null || cat "$work/results"
echo "== all of it in $SECONDS s"
! grep -q ' FAILED ' "$work/results"
