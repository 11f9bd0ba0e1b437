#!/usr/bin/env bash
# The crate as its users get it: packs it, unpacks it elsewhere, and lints it and a program on it (examples/compass.rs), with the features that the crate
# asks for itself, so that its enums may grow, and not as a member of this workspace.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
need packed "${rust_tools[@]}" "${rust_checks[@]}" tar:tar
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cargo package --quiet --locked --no-verify --allow-dirty -p magcomp --target-dir "$work/target"
mkdir -p "$work/user/src" "$work/user/magcomp"
tar -xzf "$work"/target/package/magcomp-*.crate -C "$work/user/magcomp" --strip-components 1
for file in LICENSE-MIT LICENSE-APACHE README.md; do
    [ -s "$work/user/magcomp/$file" ] || { echo "packed: the crate lacks $file" >&2; exit 1; }
done
for key in repository documentation description license readme; do
    grep -q "^$key = " "$work/user/magcomp/Cargo.toml" || { echo "packed: the crate's manifest has no $key" >&2; exit 1; }
done
cp rust/magcomp/examples/compass.rs "$work/user/src/main.rs"
cp Cargo.lock "$work/user/"
printf '[package]\nname = "user"\nedition = "2024"\n[dependencies]\nmagcomp = { path = "magcomp" }\n[workspace]\nmembers = ["magcomp"]\n' >"$work/user/Cargo.toml"
# the profile and the compiler's plugins as here: these were checked before; the crate and all that it calls are not
sed -n '/^\[profile.dev\]/,/^$/p' Cargo.toml >>"$work/user/Cargo.toml"
sed -n '/^\[build-dependencies\]/,/^$/p' tests/Cargo.toml >>"$work/user/Cargo.toml"
# the same versions as here, without the members that are not there
cargo clippy --quiet --workspace --lib --bins --manifest-path "$work/user/Cargo.toml" --target-dir "$target" -- -D warnings
echo "packed: $(cd "$work/target/package" && ls magcomp-*.crate), $(wc -c <"$work/target/package/"magcomp-*.crate) bytes; a program is built on it"
