#!/usr/bin/env bash
# Writes what is made of the tables bindings/*.toml (rust/magcomp-bindings), then bindings/kotlin and bindings/swift from the library. With
# --check, fails when the committed ones differ.
set -euo pipefail
cd "$(dirname "$0")/.."
case "${1:-}" in
    "" | --check) ;;
    *) echo "usage: bindings/generate.sh [--check]" >&2; exit 2 ;;
esac
. tests/need.sh
need bindings "${rust_tools[@]}" perl:perl-base
# first: the library is built from what it writes
cargo run --quiet --locked --profile test --package magcomp-bindings -- "$@"
. tests/native.sh
# alone: beside the workspace its features would make cargo build Arrow and Parquet a second time
cargo build --quiet --locked --profile test --package uniffi-bindgen
fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT
# --no-format: the committed files do not depend on which formatters are installed
# the static library: a stripped shared one has lost what the generator reads
"$target/debug/uniffi-bindgen" generate "$native/libmagcomp_ffi.a" -l kotlin --no-format -o "$fresh/kotlin"
"$target/debug/uniffi-bindgen" generate "$native/libmagcomp_ffi.a" -l swift --no-format -o "$fresh/swift"
for file in kotlin/org/magcomp/core/magcomp_ffi.kt swift/Magcomp.swift swift/MagcompFFI.h swift/MagcompFFI.modulemap; do
    [ -s "$fresh/$file" ] || { echo "bindings: $file was not generated; was uniffi.toml read?" >&2; exit 1; }
    # the generator leaves spaces at line ends
    sed -i 's/[ \t]*$//' "$fresh/$file"
done
perl bindings/uniffi.pl kotlin "$fresh/kotlin/org/magcomp/core/magcomp_ffi.kt"
perl bindings/uniffi.pl swift "$fresh/swift/Magcomp.swift"
if [ "${1:-}" = --check ]; then
    for language in kotlin swift; do
        diff -r "bindings/$language" "$fresh/$language" || {
            echo "bindings: the committed $language differs (<) from a new one (>); run bindings/generate.sh and commit" >&2
            exit 1
        }
    done
    echo "bindings: up to date"
else
    for language in kotlin swift; do
        rm -rf "bindings/$language"
        cp -r "$fresh/$language" "bindings/$language"
    done
fi
