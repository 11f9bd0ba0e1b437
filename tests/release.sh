#!/usr/bin/env bash
# A release's dry run: builds all that this machine can, from a clean clone of the last commit, gathers it in target/release-dry-run with a list
# of checksums, and uses each as its users would; beside each lies its list of parts (CycloneDX). `tests/release.sh`, or some of: crate c wheel aar
# xcframework page. Publishes nothing.
# The AAR's and the XCFramework's libraries are linked against stand-ins here: their form is checked, they are not for shipping.
set -euo pipefail
cd "$(dirname "$0")/.."
parts=(crate c wheel aar xcframework page)
. tests/need.sh
need release "${rust_tools[@]}" git:git tar:tar sha256sum:coreutils python3:python3
need_cargo release cargo-cyclonedx@0.5.9
tests/versions.sh
[ -z "$(git status --porcelain)" ] || { echo "release: the tree has changes; commit them first" >&2; exit 1; }
version=$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' Cargo.toml)
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
out=$target/release-dry-run
rm -rf "$out"
mkdir -p "$out"
clone=$(mktemp -d)
trap 'rm -rf "$clone"' EXIT
git clone --quiet . "$clone/magcomp"
cd "$clone/magcomp"
export CARGO_TARGET_DIR=$target/release
# the times in the wheel and the lists of parts
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH

# packed FOLDER NAME: the same files give the same archive
packed() {
    tar --sort=name --mtime='UTC 1980-01-01' --owner=0 --group=0 --numeric-owner --format=ustar -C "$1" -c . | gzip -n -9 >"$out/$2.tar.gz"
}

# parts_of ARTIFACT FOLDER PACKAGE TARGET: what the package links there, checked against cargo's own tree
parts_of() {
    cargo cyclonedx --quiet --format json --spec-version 1.5 --no-build-deps --manifest-path "$2/Cargo.toml" --target "$4" --override-filename parts
    sed "s#file://$PWD/#file://magcomp/#g" "$2/parts.json" >"$out/$1.cdx.json" # not where it was built
    tests/notices.py --parts "$out/$1.cdx.json" "$2/Cargo.toml" "$3" "$4"
}
host=$(rustc -vV | sed -n 's/^host: //p')

crate() {
    cargo package --quiet --locked -p magcomp
    cp "$CARGO_TARGET_DIR/package/magcomp-$version.crate" "$out/"
    # as a user: a package of its own that depends on what the archive holds
    local user=$clone/user
    mkdir -p "$user/src" "$user/magcomp"
    tar -xzf "$out/magcomp-$version.crate" -C "$user/magcomp" --strip-components 1
    [ -s "$user/magcomp/LICENSE-MIT" ] && [ -s "$user/magcomp/LICENSE-APACHE" ] && [ -s "$user/magcomp/README.md" ] ||
        { echo "release: the crate lacks a licence or README" >&2; exit 1; }
    printf '[package]\nname = "user"\nedition = "2024"\n[dependencies]\nmagcomp = { path = "magcomp" }\n[workspace]\n' >"$user/Cargo.toml"
    echo 'fn main() { println!("{}", magcomp::Compensator::new(magcomp::Config::default()).unwrap().gaps()) }' >"$user/src/main.rs"
    [ "$(cargo run --quiet --manifest-path "$user/Cargo.toml")" = 0 ]
    parts_of "magcomp-$version.crate" rust/magcomp magcomp "$host"
}

c() {
    local prefix=$clone/c-prefix build=$clone/c-build again
    cmake -S c -B "$build" >/dev/null
    cmake --build "$build" >/dev/null
    cmake --install "$build" --prefix "$prefix" >/dev/null
    packed "$prefix" "magcomp-c-$version-linux-$(uname -m)"
    again=$(sha256sum <"$out/magcomp-c-$version-linux-$(uname -m).tar.gz")
    packed "$prefix" "magcomp-c-$version-linux-$(uname -m)"
    [ "$again" = "$(sha256sum <"$out/magcomp-c-$version-linux-$(uname -m).tar.gz")" ]
    # as a user: unpacked elsewhere, found by pkg-config
    mkdir "$clone/c-user"
    tar -xzf "$out/magcomp-c-$version-linux-$(uname -m).tar.gz" -C "$clone/c-user"
    # shellcheck disable=SC2046 # its words are options
    cc -o "$clone/c-stream" c/examples/stream.c $(PKG_CONFIG_PATH=$clone/c-user/lib/pkgconfig pkg-config --define-prefix --cflags --libs magcomp) -lm
    LD_LIBRARY_PATH=$clone/c-user/lib "$clone/c-stream" </dev/null >/dev/null
    parts_of "magcomp-c-$version-linux-$(uname -m).tar.gz" c magcomp-c "$host"
}

wheel() {
    PROFILE=release tests/python.sh
    cp "$CARGO_TARGET_DIR"/python/wheels/magcomp-*.whl "$out/"
    parts_of "$(cd "$out" && ls magcomp-*.whl)" python magcomp-python "$host"
}

aar() {
    PROFILE=ship tests/aar.sh all
    cp android/aar/target/*.aar android/aar/target/*-sources.jar android/aar/target/*-javadoc.jar android/host/target/magcomp-host-*.jar "$out/"
    parts_of "$(cd "$out" && ls ./*.aar)" rust/magcomp-ffi magcomp-ffi aarch64-linux-android
    parts_of "magcomp-host-$version.jar" rust/magcomp-ffi magcomp-ffi "$host"
}

xcframework() {
    PROFILE=ship tests/xcframework.sh all
    cp "$CARGO_TARGET_DIR/ios/MagcompFFI.xcframework.zip" "$out/"
    parts_of MagcompFFI.xcframework.zip rust/magcomp-ffi magcomp-ffi aarch64-apple-ios
}

page() {
    tests/web.sh
    cp "$CARGO_TARGET_DIR/web-test/magcomp.html" "$out/"
    parts_of magcomp.html web magcomp-web wasm32-unknown-unknown
}

for part in "${@:-${parts[@]}}"; do
    case " ${parts[*]} " in
        *" $part "*) ;;
        *) echo "unknown part '$part'; parts are: ${parts[*]}" >&2; exit 2 ;;
    esac
    echo "== $part"
    [ "$part" != c ] || need release c++:g++ cmake:cmake make:make pkg-config:pkg-config
    "$part"
done
cd "$out"
sha256sum -- * >SHA256SUMS
printf '| artifact | bytes |\n|---|---|\n'
wc -c -- * | sed '$d' | awk '!/\.cdx\.json$/ { printf "| `%s` | %d |\n", $2, $1 }'
echo "release: $version, all of it in $out"
