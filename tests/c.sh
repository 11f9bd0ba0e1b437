#!/usr/bin/env bash
# The library for C and C++: builds and installs c/ into a folder of its own, then builds programs on what was installed, by CMake and by pkg-config,
# shared and static, with warnings as errors and under AddressSanitizer and UBSan. They refuse hostile input as c/tests says, and read a recording as the
# core does, bit for bit. c/abi.txt is compared with the header, the library and the sources. `tests/c.sh`, also `tests/run.sh c`; the unit tests of c/src run with all others of Rust.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
need c "${rust_tools[@]}" c++:g++ cmake:cmake make:make pkg-config:pkg-config nm:binutils readelf:binutils
fail() { echo "c: $*" >&2; exit 1; }
. tests/native.sh
home=$target/c
cargo build --quiet --locked --profile "$profile" "${workspace[@]}" --example compass
expected "$home/expected.txt"
# as its README says
prefix=$home/prefix
rm -rf "$prefix" "$home/moved" "$home/consumer" "$home/build/CMakeCache.txt"
cmake -S c -B "$home/build" >/dev/null
cmake --build "$home/build"
cmake --install "$home/build" --prefix "$prefix" >/dev/null

# abi.txt: exported functions, cases and layouts
of_abi() { sed -n "s/^$1 //p" c/abi.txt; }
header=$prefix/include/magcomp.h
nm -D --defined-only "$prefix/lib/libmagcomp.so" | sed 's/.* //' | sort | diff <(of_abi function) - ||
    fail "libmagcomp.so exports other names than c/abi.txt lists"
sed 's:^ *//.*::' "$header" | grep -oE '\bmagcomp_[a-z_]+\(' | tr -d '(' | sort | diff <(of_abi function) - ||
    fail "magcomp.h declares other functions than c/abi.txt lists"
sed -n 's/^ *\(MAGCOMP_[A-Z_0-9]*\) = \(-\?[0-9]*\),$/\1 \2/p' "$header" | diff <(of_abi case) - || fail "magcomp.h has other cases than c/abi.txt lists"
for language in c:_Static_assert cpp:static_assert; do
    {
        echo '#include <magcomp.h>'
        of_abi struct | while read -r type size; do echo "${language#*:}(sizeof($type) == $size, \"\");"; done
        of_abi member | while read -r type member offset size; do
            echo "${language#*:}(offsetof($type, $member) == $offset && sizeof((($type *)0)->$member) == $size, \"$member\");"
        done
        of_abi case | while read -r name value; do echo "${language#*:}($name == $value, \"$name\");"; done
    } >"$home/layout.${language%:*}"
done
readelf -d "$prefix/lib/libmagcomp.so" | grep -q 'SONAME.*\[libmagcomp\.so\.0\.1\]' || fail "the shared library has no versioned name"

for file in LICENSE-MIT LICENSE-APACHE c/THIRD-PARTY-NOTICES; do
    cmp "$file" "$prefix/share/doc/magcomp/${file##*/}" || fail "$file is not installed"
done

# the installed folder may be moved
mv "$prefix" "$home/moved"
prefix=$home/moved
! grep -rqF "$home/prefix" "$prefix"/lib/pkgconfig "$prefix"/lib/cmake "$prefix"/include || fail "an installed file names the prefix"
cmake -S c/tests -B "$home/consumer" -DCMAKE_PREFIX_PATH="$prefix" -DLAYOUT="$home/layout" >/dev/null
cmake --build "$home/consumer" | sed '/Built target/d; /^\[/d'
by_pkg_config() { PKG_CONFIG_PATH=$prefix/lib/pkgconfig pkg-config "$@" magcomp; }
cc -std=c99 -Wall -Wextra -Wpedantic -Werror c/examples/stream.c -o "$home/by-pkg-config" $(by_pkg_config --cflags --libs)
cc -std=c99 -Wall -Wextra -Wpedantic -Werror c/examples/stream.c -o "$home/by-pkg-config-static" $(by_pkg_config --cflags) \
    "$(by_pkg_config --variable=libdir)/libmagcomp.a" $(by_pkg_config --static --libs-only-other --libs-only-l | sed 's/-lmagcomp//')

# a project that fetches the sources: the committed ones, but for what is being changed here
sed -n '/^```cmake$/,/^```$/p' c/README.md | sed '1d;$d' | sed 's|https://github.com/[^ ]*|${REPOSITORY}|; s|GIT_TAG v[0-9.]*|GIT_TAG ${TAG}|' |
    while IFS= read -r line; do grep -qxF -- "$line" c/tests/fetched/CMakeLists.txt || fail "c/README.md shows a line that c/tests/fetched does not have: $line"; done
cmake -S c/tests/fetched -B "$home/fetched" -DMAGCOMP_TARGET_DIR="$home/build/cargo" -DFETCHCONTENT_SOURCE_DIR_MAGCOMP="$PWD" >/dev/null
cmake --build "$home/fetched" | sed '/Built target/d; /^\[/d'

# the README's code is the example
sed -n '/^```c$/,/^```$/p' c/README.md | sed '1d;$d' | diff c/examples/stream.c - || fail "c/README.md shows another program than c/examples/stream.c"

sed -n '/^```cpp$/,/^```$/p' README.md | sed '1d;$d' | while IFS= read -r line; do
    grep -qF -- "$line" c/examples/stream.cpp || fail "README.md shows a line that c/examples/stream.cpp does not have: $line"
done

shown=$(tr '\n' ' ' <README.md | sed -n 's/.*at the end of the recording `broad_34`, in \[this program\](c\/examples\/stream.cpp): `\([^`]*\)`.*/\1/p')
[ -n "$shown" ] || fail "README.md does not say what c/examples/stream.cpp prints"

# events of a recording: sensor, time in ns, three values
zcat tests/recordings/broad_34_attached_magnet_3cm.csv.gz | awk -F, 'NR > 1 {
    t = sprintf("%.0f", $1 * 1e9)
    print "g", t, $8, $9, $10; print "a", t, $5, $6, $7; print "m", t, $2, $3, $4
}' >"$home/events.txt"
grep '^reading' "$home/expected.txt" >"$home/readings.txt"
for kind in magcomp static; do
    "$home/consumer/borders_$kind"
    "$home/consumer/wrapper_$kind"
    "$home/consumer/recording_$kind" <"$home/events.txt" | cmp - "$home/readings.txt" || fail "$kind: readings are not the core's"
    for language in c cpp; do
        "$home/consumer/stream_${language}_$kind" <"$home/events.txt" >"$home/stream.$language" 2>"$home/kept.$language"
        grep -q '"magcomp_calibration":1' "$home/kept.$language" || fail "stream.$language kept nothing"
    done
    "$native/examples/compass" <"$home/events.txt" 2>/dev/null | tr A-Z a-z | diff - <(tr A-Z a-z <"$home/stream.c") >/dev/null ||
        fail "$kind: the example in C says something else than rust/magcomp/examples/compass.rs"
    "$home/fetched/stream_$kind" <"$home/events.txt" 2>/dev/null | diff - "$home/stream.cpp" >/dev/null || fail "$kind: fetched, the example says something else"
    [ "$(tail -n 1 "$home/stream.cpp")" = "$shown" ] || fail "$kind: README.md shows another last line: $shown"
    diff "$home/stream.c" "$home/stream.cpp" || fail "$kind: the example in C++ says something else than that in C"
done
for program in by-pkg-config by-pkg-config-static; do
    LD_LIBRARY_PATH=$prefix/lib "$home/$program" <"$home/events.txt" 2>/dev/null | diff - "$home/stream.c" >/dev/null || fail "$program says something else"
done
echo "c: $(wc -l <"$home/readings.txt") readings are the core's, bit for bit; $(of_abi function | wc -l) functions"
