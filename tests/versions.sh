#!/usr/bin/env bash
# One version number, wherever a file has to repeat it.
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
for manifest in python/Cargo.toml c/Cargo.toml web/Cargo.toml; do
    mapfile -t found < <(sed -n '/^\[package\]/,/^\[/s/^version = "\(.*\)"/\1/p' $manifest)
    differs $manifest "${found[@]}"
done
grep -q "^## $version" CHANGELOG.md || { echo "versions: CHANGELOG.md has no section for $version" >&2; exit 1; }
