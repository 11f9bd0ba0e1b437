#!/usr/bin/env bash
# Stages the AAR and the magcomp-host that tests/aar.sh packed, signed with a key of its own; checks the folder as Maven Central does
# (tests/staged.py), and that the check finds what is broken; then builds and runs an app that knows the two by their coordinates alone.
# tests/aar.sh runs it. The artifacts are structure checks, the host's library a build for tests.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
need staging "${java_tools[@]}" python3:python3 gpg:gnupg unzip:unzip
mvn() { command mvn --batch-mode --no-transfer-progress -Dorg.slf4j.simpleLogger.defaultLogLevel=warn "$@"; }

work=$(mktemp -d)
trap 'gpgconf --homedir "$work/gpg" --kill gpg-agent 2>/dev/null || true; rm -rf "$work"' EXIT
export GNUPGHOME=$work/gpg
mkdir -m 700 "$GNUPGHOME"
gpg --batch --quiet --passphrase '' --quick-generate-key 'a test of magcomp' default default never 2>/dev/null
android/stage.sh "$work/staging"
tests/staged.py "$work/staging"

# the check finds each of these
broken() { # WHAT COMMAND...: in a copy
    local what=$1
    shift
    rm -rf "$work/broken"
    cp -r "$work/staging" "$work/broken"
    (cd "$work/broken/org/magcomp/magcomp-host/"* && "$@")
    if tests/staged.py "$work/broken" >"$work/said" 2>&1; then echo "staging: tests/staged.py takes $what" >&2; exit 1; fi
    grep -q "^staged: magcomp-host" "$work/said" || { cat "$work/said" >&2; exit 1; }
}
pom=$(basename "$work"/staging/org/magcomp/magcomp-host/*/*.pom)
broken 'a POM without an scm' sed -i '/<scm>/,/<\/scm>/d' "$pom"
broken 'a POM without a developer' sed -i '/<developer>/d' "$pom"
broken 'a licence without a text' sed -i 's#<url>https://opensource.org/license/mit</url>##' "$pom"
broken 'a POM of another version' sed -i '0,/<version>/s/<version>.*</<version>0.0.9-SNAPSHOT</' "$pom"
broken 'a placeholder' sed -i 's#<name>magcomp-host#<name>@name@#' "$pom"
broken 'no sources' rm "${pom%.pom}-sources.jar"
broken 'no pages' rm "${pom%.pom}-javadoc.jar"
broken 'no signature' rm "$pom.asc"
broken 'a signature of another file' cp "${pom%.pom}.jar.asc" "$pom.asc"
broken 'a checksum of another file' cp "${pom%.pom}.jar.sha1" "$pom.sha1"

# an app whose Maven knows nothing of org.magcomp but the staged: a local repository with links to all else
artifact=$(basename "$(dirname "$(dirname "$(find "$work/staging" -name '*.aar')")")")
local_repository=${MAVEN_REPOSITORY:-$HOME/.m2/repository}
mkdir -p "$work/m2/org"
for entry in "$local_repository"/*; do [ "${entry##*/}" = org ] || ln -s "$entry" "$work/m2/"; done
for entry in "$local_repository"/org/*; do [ "${entry##*/}" = magcomp ] || ln -s "$entry" "$work/m2/org/"; done
app=android/host/outsider
rm -rf $app/target
mvn --file $app/pom.xml -Dmaven.repo.local="$work/m2" -Dstaging="file://$work/staging" -Daar.artifact="$artifact" verify \
    org.apache.maven.plugins:maven-dependency-plugin:3.8.1:copy-dependencies -DincludeScope=runtime
grep -q 'staging' "$work/m2/org/magcomp/$artifact"/*/_remote.repositories
# the same app with the AAR's classes before all others
got=$app/target/dependency
unzip -q -o "$got/$artifact"-*.aar classes.jar -d "$work"
jars=$(find $got -name '*.jar' | tr '\n' ':')
# an object's number differs from run to run
java -cp "$app/target/classes:$jars" app.Main | sed -E 's/@[0-9a-f]+//g' >"$work/host"
java -cp "$app/target/classes:$work/classes.jar:$jars" app.Main | sed -E 's/@[0-9a-f]+//g' >"$work/aar"
cmp "$work/host" "$work/aar"
grep -q fieldStrengthUt "$work/aar"
echo "staging: an app runs with the staged AAR's classes and with magcomp-host, and prints the same; it resolved:"
(cd $got && ls)
