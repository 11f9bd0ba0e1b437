#!/usr/bin/env bash
# Builds the XCFramework without a Mac (ios/build-xcframework.sh) and checks its parts: property list against folders,
# architecture, platform and minimum version of every object, headers and what they declare against what the libraries
# define, the interfaces Apple wants a reason for against the privacy manifest, its files against those of another Rust
# framework in the same app. Links the device's slice as an app would and prints what is left after dead-stripping.
# `tests/xcframework.sh` builds the device's slice alone, `tests/xcframework.sh all` those of simulators and macOS too,
# `tests/xcframework.sh built` checks the one that is there, for one that was built on a Mac. LLVM is the suffix of the LLVM
# tools' names, by default that of Debian's newest. Needs llvm, lld and Python 3, and where rustup has no standard library for a target, rustc-web,
# cargo-web and rust-web-src; installs them as root, on Debian. Not for shipping, and not tried in Xcode.
set -euo pipefail
export LC_ALL=C
cd "$(dirname "$0")/.."
case "$*" in
    "") slices=ios-arm64 options=(--device) ;;
    all | built) slices='ios-arm64 ios-arm64_x86_64-simulator macos-arm64_x86_64' options=() ;;
    *) echo "usage: tests/xcframework.sh [all | built]" >&2; exit 2 ;;
esac
. tests/need.sh
need xcframework python3:python3
need_llvm xcframework llvm-nm:llvm llvm-objdump:llvm llvm-size:llvm ld64.lld:lld
fail() { echo "xcframework: $*" >&2; exit 1; }

[ "$*" = built ] || ios/build-xcframework.sh ${options[@]+"${options[@]}"}
target=${CARGO_TARGET_DIR:-$PWD/target}
framework=$target/ios/MagcompFFI.xcframework
work=$target/ios/check
mkdir -p "$work"

# the property list names what is there, and nothing else is there
python3 - "$framework" >"$work/slices" <<'PYTHON'
import pathlib, plistlib, sys

framework = pathlib.Path(sys.argv[1])
info = plistlib.loads((framework / "Info.plist").read_bytes())
assert info["CFBundlePackageType"] == "XFWK" and info["XCFrameworkFormatVersion"] == "1.0", info
known = {framework / name for name in ("Info.plist", "LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY-NOTICES")}
for library in info["AvailableLibraries"]:
    folder = framework / library["LibraryIdentifier"]
    variant = library.get("SupportedPlatformVariant", "")
    architectures = "_".join(library["SupportedArchitectures"])
    name = "-".join(filter(None, [library["SupportedPlatform"], architectures, variant]))
    assert folder.name == name, f"{folder.name}, expected {name}"
    assert library["LibraryPath"] == library["BinaryPath"], library
    assert library["HeadersPath"] == "Headers", library
    # a folder of our own: Xcode merges the Headers of all frameworks of an app
    headers = folder / "Headers" / "MagcompFFI"
    known |= {folder / library["LibraryPath"], headers / "module.modulemap"}
    known |= {headers / "MagcompFFI.h", headers / "magcomp.h"}
    platform = {"ios": "ios", "ios-simulator": "iossimulator", "macos": "macos"}
    platform = platform["-".join(filter(None, [library["SupportedPlatform"], variant]))]
    for architecture in library["SupportedArchitectures"]:
        print(folder.name, platform, architecture)
    # Xcode copies all Headers and libraries of an app into two folders; another framework as uniffi's tools make it
    ours = {path.relative_to(folder / "Headers") for path in headers.rglob("*")} | {pathlib.Path(library["LibraryPath"])}
    theirs = {pathlib.Path(name) for name in ("module.modulemap", "OtherFFI.h", "libother_ffi.a", "OtherFFI/module.modulemap")}
    assert not ours & theirs, ours & theirs
there = {path for path in framework.rglob("*") if path.is_file()}
assert there == known, there ^ known
PYTHON
[ "$(cut -d' ' -f1 "$work/slices" | sort -u | xargs)" = "$slices" ] || fail "slices: $(cat "$work/slices")"

for file in LICENSE-MIT LICENSE-APACHE ios/THIRD-PARTY-NOTICES; do
    cmp "$file" "$framework/${file##*/}" || fail "$file is not in it"
done

# names the headers declare, as symbols
cat bindings/swift/MagcompFFI.h rust/magcomp-ffi/include/magcomp.h | grep -oE '\b(uniffi_magcomp_ffi|ffi_magcomp_ffi|magcomp)_[a-z0-9_]+ *\(' |
    sed 's/ *($//; s/^/_/' | sort -u >"$work/declared"
[ "$(wc -l <"$work/declared")" -gt 60 ] || fail "the headers declare $(wc -l <"$work/declared") functions only"

while read -r slice platform architecture; do
    [ "$platform" = macos ] && least=14.0 || least=17.0
    library=$framework/$slice/libmagcomp_ffi.a
    for header in bindings/swift/MagcompFFI.h rust/magcomp-ffi/include/magcomp.h; do
        cmp "$header" "$framework/$slice/Headers/MagcompFFI/${header##*/}"
    done
    # one line for every kind of object; those of rustup's standard library are for older systems, too
    "llvm-objdump$llvm" --macho --arch="$architecture" --private-headers "$library" >"$work/objects"
    kinds=$(awk '/^Mach header/ { getline; getline; print "arch", $2 } $1 == "platform" { print $1, $2 }
        $1 == "minos" && $2 > minos { minos = $2 } END { print "minos", minos }' "$work/objects" | sort -u)
    [ "$kinds" = "$(printf 'arch %s\nminos %s\nplatform %s' "$(tr a-z A-Z <<<"$architecture")" "$least" "$platform")" ] || fail "$slice: objects are $kinds"
    "llvm-nm$llvm" --arch="$architecture" --defined-only --extern-only --format=just-symbols "$library" | sort -u >"$work/defined"
    missing=$(comm -23 "$work/declared" "$work/defined")
    [ -z "$missing" ] || fail "$slice: declared and not defined: $missing"
    if grep -q '^_magcomp_test_' "$work/defined"; then fail "$slice: holds test hooks"; fi
    if grep -q '^  *segname __LLVM' "$work/objects"; then fail "$slice: holds bitcode"; fi
    printf 'xcframework: %-26s %9d bytes, %-6s, %s, all %d functions\n' "$slice" "$(wc -c <"$library")" \
        "$architecture" "$platform $least" "$(wc -l <"$work/declared")"
done <"$work/slices"

# the same files give the same zip, whatever their times and the order they were made in
ios/build-xcframework.sh --zip >/dev/null
cp "$framework.zip" "$work/first.zip"
rm -rf "$work/copy"
mv "$framework" "$work/copy"
mkdir "$framework"
(cd "$work/copy" && find . -type f | LC_ALL=C sort -r) | while read -r file; do
    mkdir -p "$framework/$(dirname "$file")"
    cp "$work/copy/$file" "$framework/$file"
done
TZ=Asia/Tokyo ios/build-xcframework.sh --zip
cmp "$work/first.zip" "$framework.zip" || fail "the same files gave another zip"
python3 - "$framework.zip" <<'PYTHON'
import sys, zipfile

entries = zipfile.ZipFile(sys.argv[1]).infolist()
names = [entry.filename for entry in entries]
assert names == sorted(names) and {entry.date_time for entry in entries} == {(1980, 1, 1, 0, 0, 0)}, names
for entry in entries:
    if entry.filename.endswith(".a"):
        print(f"xcframework: {entry.filename.split('/')[1]}: {entry.file_size} bytes, {entry.compress_size} in the zip")
PYTHON

# what an app gets of it: all that Swift may call, and what that needs
"ld64.lld$llvm" -arch arm64 -platform_version ios 17.0 18.0 -dylib -dead_strip -S -x -exported_symbols_list "$work/declared" \
    -undefined dynamic_lookup -o "$work/linked" "$framework/ios-arm64/libmagcomp_ffi.a"
printf 'xcframework: %d bytes of arm64 after dead-stripping: %s\n' "$(wc -c <"$work/linked")" \
    "$("llvm-size$llvm" -m "$work/linked" | sed -n 's/^Segment \(.*\): \([0-9]*\).*/\1 \2/p' | tr '\n' ' ')"

# Apple's list of required-reason interfaces, as far as C has them
"llvm-nm$llvm" --undefined-only --format=just-symbols "$work/linked" | sort -u >"$work/imports"
tests/privacy.py "$work/imports"
(cd "$framework/.." && find MagcompFFI.xcframework -type f | sort)
echo "xcframework: all parts are there, for $slices"
