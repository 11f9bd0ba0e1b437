#!/usr/bin/env bash
# Lays out what Maven Central takes: `android/stage.sh FOLDER` puts the AAR of android/aar/target and the jar of android/host/target there, each with its
# POM, sources, pages, checksums, and signatures of gpg's default key (GPG_KEY: another). tests/staged.py checks such a folder as Central does;
# `(cd FOLDER && zip -r ../bundle.zip .)` is what Central's portal takes.
set -euo pipefail
folder=$(realpath -m "$1")
cd "$(dirname "$0")"

aar=(aar/target/*.aar)
[ ${#aar[@]} = 1 ] && [ -f "${aar[0]}" ] || { echo "stage: android/aar/target has not one AAR: ${aar[*]}" >&2; exit 1; }
aar=${aar[0]%.aar} # the path without its end
version=$(sed -n 's#^  <version>\(.*\)</version>#\1#p' "$aar.pom")
name=$(basename "$aar" "-$version")

put() { # ARTIFACT END FILE
    install -D -m 644 "$3" "$folder/org/magcomp/$1/$version/$1-$version$2"
}
for end in .aar .pom -sources.jar -javadoc.jar; do put "$name" $end "$aar$end"; done
put magcomp-host .pom host/target/consumer.pom
put magcomp-host .jar "host/target/magcomp-host-$version.jar"
# its classes are the AAR's
for end in -sources.jar -javadoc.jar; do put magcomp-host $end "$aar$end"; done

for file in "$folder"/org/magcomp/{"$name",magcomp-host}/"$version"/*; do
    gpg --batch --yes --quiet ${GPG_KEY:+--local-user "$GPG_KEY"} --armor --detach-sign "$file"
    for sum in md5 sha1 sha256 sha512; do ${sum}sum "$file" | cut -d ' ' -f 1 >"$file.$sum"; done
done
echo "stage: $name and magcomp-host $version are in $folder"
