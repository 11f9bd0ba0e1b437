#!/usr/bin/env bash
# A release's dry run: builds all that this machine can, from a clean clone of the last commit, gathers it in target/release-dry-run with a list
# of checksums, and uses each as its users would. `tests/release.sh`, or some of: crate c wheel aar xcframework. Publishes nothing.
# The AAR's and the XCFramework's libraries are linked against stand-ins here: their form is checked, they are not for shipping.
set -euo pipefail
cd "$(dirname "$0")/.."
parts=(crate c wheel aar xcframework)
. tests/need.sh
need release "${rust_tools[@]}" git:git tar:tar sha256sum:coreutils zip:zip
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

# packed FOLDER NAME: the same files give the same archive
packed() {
    tar --sort=name --mtime='UTC 1980-01-01' --owner=0 --group=0 --numeric-owner --format=ustar -C "$1" -c . | gzip -n -9 >"$out/$2.tar.gz"
}

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
}

wheel() {
    tests/python.sh
    cp "$CARGO_TARGET_DIR"/python/wheels/magcomp-*.whl "$out/"
}

aar() {
    tests/aar.sh all
    cp android/aar/target/*.aar android/aar/target/*-sources.jar android/aar/target/*-javadoc.jar "$out/"
}

xcframework() {
    tests/xcframework.sh all
    cp "$CARGO_TARGET_DIR/ios/MagcompFFI.xcframework.zip" "$out/"
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
(cd "$out" && sha256sum ./* >SHA256SUMS && wc -c ./*)
echo "release: $version, all of it in $out"
