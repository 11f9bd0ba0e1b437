#!/usr/bin/env bash
# The Android libraries without an NDK: builds them, linked against stand-ins of the system's libraries (android/stubs).
# Prints their sizes and audits what they export and import and how they are aligned. PROFILE=ship builds them as phones get them, with a standard
# library of their own, which takes longer, and limits their size.
# NOT for shipping: their unwinder is a stand-in. iOS: tests/xcframework.sh.
# `tests/mobile.sh` builds arm64-v8a, which is most phones; `tests/mobile.sh ABI...` others, `tests/mobile.sh all` all four.
# Result: target/android/<abi>/libmagcomp_ffi.so.
# Needs clang and lld, and where rustup has no standard library for a target, rustc-web, cargo-web and rust-web-src; installs them as root, on Debian.
set -euo pipefail
cd "$(dirname "$0")/.."
[ "$*" = all ] && set -- arm64-v8a armeabi-v7a x86_64 x86
wanted=("${@:-arm64-v8a}")
for abi in "${wanted[@]}"; do
    case "$abi" in
        arm64-v8a | armeabi-v7a | x86_64 | x86) ;;
        *) echo "usage: tests/mobile.sh [all | arm64-v8a | armeabi-v7a | x86_64 | x86]..." >&2; exit 2 ;;
    esac
done
. tests/need.sh
need mobile clang-19:clang-19 ld.lld-19:lld-19 readelf:binutils nm:binutils ar:binutils

target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
profile=${PROFILE:-dev}
folder=${profile/#dev/debug}
export CARGO_TARGET_DIR=$target/mobile

# stubs CLANG_TARGET FOLDER: shared libraries with the names of android/stubs, an unwinder that aborts, __dso_handle
stubs() {
    local clang=(clang-19 --target="$1" -nostdlib -x c) library
    mkdir -p "$2"
    for library in libc libm libdl liblog; do
        {
            cat "android/stubs/$library.txt"
            # rustup's standard library prints backtraces, and what is linked less thoroughly keeps a clock that nothing calls
            [ "$library $profile" != 'libc dev' ] || printf '%s\n' clock_gettime dl_iterate_phdr fstat lseek64 mmap munmap readlink realpath stat
        } | sed 's/.*/void &(void) {}/' |
            "${clang[@]}" -w -fno-builtin -fuse-ld=lld-19 -shared -Wl,-soname,$library.so -o "$2/$library.so" -
    done
    sed 's/.*/void &(void) { __builtin_trap(); }/' android/stubs/libunwind.txt |
        "${clang[@]}" -w -fno-builtin -c -o "$2/unwind.o" -
    rm -f "$2/libunwind.a"
    ar rcs "$2/libunwind.a" "$2/unwind.o"
    echo 'void *__dso_handle;' | "${clang[@]}" -c -o "$2/dso.o" -
}

# build ABI RUST_TARGET CLANG_TARGET
build() {
    need_std mobile "$2" panic-unwind
    local stubs=$CARGO_TARGET_DIR/stubs/$1 variable
    stubs "$3" "$stubs"
    variable=CARGO_TARGET_$(tr 'a-z-' 'A-Z_' <<<"$2")
    # -z defs: a name that is not in android/stubs fails the link
    export "${variable}_LINKER=clang-19" "${variable}_RUSTFLAGS=-Clink-arg=--target=$3 -Clink-arg=-fuse-ld=lld-19 \
-Clink-arg=-nostdlib -Clink-arg=-nostartfiles -Clink-arg=$stubs/dso.o -L$stubs -Clink-arg=-Wl,-z,max-page-size=16384 \
-Clink-arg=-Wl,-soname,libmagcomp_ffi.so -Clink-arg=-Wl,-T,$PWD/android/no-metadata.ld -Clink-arg=-Wl,-z,defs"
    cargo rustc --quiet --locked --profile "$profile" -p magcomp-ffi --lib --crate-type cdylib ${std[@]+"${std[@]}"} --target "$2"
    install -D "$CARGO_TARGET_DIR/$2/$folder/libmagcomp_ffi.so" "$target/android/$1/libmagcomp_ffi.so"
    audit "$1" "$target/android/$1/libmagcomp_ffi.so"
}

# audit ABI LIBRARY
audit() {
    local bad
    bad=$(readelf -lW "$2" | awk '$1 == "LOAD" && $NF != "0x4000" && $NF != "0x10000"')
    [ -z "$bad" ] || { echo "mobile: $1: a segment is not aligned to 16 KB: $bad" >&2; exit 1; }
    readelf -dW "$2" | grep -q 'soname: \[libmagcomp_ffi.so\]' || { echo "mobile: $1: the SONAME is missing" >&2; exit 1; }
    bad=$(readelf -dW "$2" | sed -n 's/.*NEEDED.*\[\(.*\)\]/\1/p' | grep -vxE 'lib(c|m|dl|log)\.so' || true)
    [ -z "$bad" ] || { echo "mobile: $1: needs $bad" >&2; exit 1; }
    local java uniffi
    java=$(nm -D --defined-only "$2" | grep -c ' Java_org_magcomp_core_FastPath_' || true)
    uniffi=$(nm -D --defined-only "$2" | grep -c ' uniffi_magcomp_ffi_fn_' || true)
    local wanted
    wanted=$(grep -c 'external fun' android/library/src/main/kotlin/org/magcomp/core/FastPath.kt)
    [ "$java" = "$wanted" ] || { echo "mobile: $1: exports $java JNI functions, Kotlin declares $wanted" >&2; exit 1; }
    wanted=$(grep -c 'external fun uniffi_magcomp_ffi_fn_' bindings/kotlin/org/magcomp/core/magcomp_ffi.kt)
    [ "$uniffi" = "$wanted" ] || { echo "mobile: $1: exports $uniffi uniffi functions, Kotlin declares $wanted" >&2; exit 1; }
    if nm -D "$2" | grep -q TestHooks; then
        echo "mobile: $1: holds test hooks" >&2
        exit 1
    fi
    printf 'mobile: %-12s %8d bytes, %d JNI and %d uniffi functions, 16 KB pages\n' "$1" "$(stat -c %s "$2")" "$java" "$uniffi"
    # what a phone downloads and keeps
    [ "$1 $profile" != 'arm64-v8a ship' ] || [ "$(stat -c %s "$2")" -lt 730000 ] || { echo "mobile: $1: 730000 bytes or more" >&2; exit 1; }
}

for abi in "${wanted[@]}"; do
    case "$abi" in
        arm64-v8a) build arm64-v8a aarch64-linux-android aarch64-linux-android21 ;;
        armeabi-v7a) build armeabi-v7a armv7-linux-androideabi armv7a-linux-androideabi21 ;;
        x86_64) build x86_64 x86_64-linux-android x86_64-linux-android21 ;;
        x86) build x86 i686-linux-android i686-linux-android21 ;;
    esac
done
echo "mobile: ${wanted[*]} passed, built with the profile $profile"
