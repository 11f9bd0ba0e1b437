#!/usr/bin/env bash
# One version number and one address, wherever a file has to repeat them. `tests/versions.sh --publish` refuses the address that stands for none.
set -euo pipefail
cd "$(dirname "$0")/.."
version=$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' Cargo.toml)
[ -n "$version" ] || { echo "versions: Cargo.toml has none" >&2; exit 1; }
differs() { # FILE FOUND...
    local found
    for found in "${@:2}"; do
        [ "$found" = "$version" ] || { echo "versions: $1 says $found, Cargo.toml $version" >&2; exit 1; }
    done
    [ $# -gt 1 ] || { echo "versions: $1 says none" >&2; exit 1; }
}
for pom in android/pom.xml android/*/pom.xml; do
    # our own: of the project, or of its parent
    mapfile -t found < <(grep -A1 '<artifactId>magcomp-android</artifactId>' "$pom" | sed -n 's:.*<version>\(.*\)</version>.*:\1:p')
    differs "$pom" "${found[@]}"
done
outsider=android/host/outsider/pom.xml
mapfile -t found < <(sed -n 's:.*<artifactId>magcomp-host</artifactId><version>\(.*\)</version>.*:\1:p' $outsider)
differs $outsider "${found[@]}"
mapfile -t found < <(grep -oE 'magcomp[:-][0-9]+\.[0-9]+\.[0-9]+' android/README.md | sed 's/.*[:-]//')
differs android/README.md "${found[@]}"
mapfile -t found < <(sed -n '/^\[package\]/,/^\[/s/^version = "\(.*\)"/\1/p' web/Cargo.toml)
differs web/Cargo.toml "${found[@]}"
mapfile -t found < <(sed -n 's:.*<version>\(.*\)</version>.*:\1:p; s/^ *version="\(.*\)",/\1/p' ros2/package.xml ros2/setup.py)
differs ros2 "${found[@]}"
mapfile -t found < <(sed -n 's/.*GIT_TAG v\([0-9.]*\).*/\1/p' c/README.md)
differs c/README.md "${found[@]}"
address=$(sed -n 's/^repository = "\(.*\)"/\1/p' Cargo.toml)
[[ "$address" == https://github.com/*/magcomp ]] || { echo "versions: Cargo.toml has no address" >&2; exit 1; }
for file in rust/magcomp/README.md c/README.md python/pyproject.toml python/README.md android/pom.xml android/gradle/publish.gradle.kts ios/README.md SECURITY.md \
    ios/Sources/Magcomp/Magcomp.docc/Resources/App-Package.swift; do
    [ "$(grep -oE 'https://github.com/[A-Za-z0-9-]+/magcomp' "$file" | sort -u)" = "$address" ] ||
        { echo "versions: $file names another address than Cargo.toml, $address, or none" >&2; exit 1; }
done
# what a registry shows has no files beside it
for file in rust/magcomp/README.md python/README.md; do
    ! sed 's:](https\://[^)]*)::g' "$file" | grep -F '](' || { echo "versions: a link of $file leads nowhere on a registry's page" >&2; exit 1; }
    for page in $(grep -oE "\]\($address/blob/main/[^)#]*" "$file" | sed 's:.*/blob/main/::'); do
        [ -f "$page" ] || { echo "versions: $file: there is no $page" >&2; exit 1; }
    done
done
[ "${1:-}" != --publish ] || [ "$address" != "https://github.com/OWNER/magcomp" ] ||
    { echo "versions: OWNER has to be replaced in Cargo.toml and in what repeats it: grep -rl github.com/OWNER ." >&2; exit 1; }
grep -q "^## $version" CHANGELOG.md || { echo "versions: CHANGELOG.md has no section for $version" >&2; exit 1; }
