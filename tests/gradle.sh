#!/usr/bin/env bash
# What can be said of the Gradle build without Gradle and Google's Maven: its versions are those of Maven's build, and every file it
# names is there. It has not been run where this runs.
set -euo pipefail
cd "$(dirname "$0")/../android"

fail() { echo "gradle: $1" >&2; exit 1; }

maven() { sed -n "s#.*<$1.version>\(.*\)</$1.version>.*#\1#p" pom.xml; }
for name in kotlin coroutines jna; do
    grep -qx "$name = \"$(maven $name)\"" gradle/libs.versions.toml || fail "gradle/libs.versions.toml has another version of $name than pom.xml, $(maven $name)"
done
version=$(sed -n 's#^  <version>\(.*\)</version>#\1#p' pom.xml)
least=$(sed -n 's#.*<min.sdk>\(.*\)</min.sdk>.*#\1#p' pom.xml)
for line in "version = \"$version\"" "coreLibrariesVersion = \"$(maven kotlin.stdlib)\"" "defaultConfig { minSdk = $least }"; do
    grep -qx " *$line" build.gradle.kts || fail "build.gradle.kts has no line '$line', which is pom.xml's"
done

# every rootDir.resolve("...") and every module
for path in $(grep -hoP 'rootDir\.resolve\("\K[^"]+' ./*/build.gradle.kts); do
    case "$path" in ../target*) continue ;; esac # built
    [ -e "$path" ] || fail "there is no $path"
done
for module in $(grep -oP '":\K[a-z]+' settings.gradle.kts); do [ -f "$module/build.gradle.kts" ] || fail "there is no module $module"; done

# every alias is in the catalog, and nothing in the catalog is left over
used=$(grep -hoP 'libs\.\K[a-z.]+[a-z]' ./build.gradle.kts ./*/build.gradle.kts | sed 's/^plugins\.//; s/\./-/g' | sort -u)
known=$(grep -oP '^[a-z-]+(?= = \{)' gradle/libs.versions.toml | sort -u)
[ "$used" = "$known" ] || fail "the catalog and its uses differ: $(diff <(echo "$used") <(echo "$known") | tr '\n' ' ')"
echo "gradle: versions, paths and catalog agree; the build itself was not run"
