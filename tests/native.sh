# Sourced, after need.sh: builds the library with its test hooks, and the example that says what Kotlin and Swift have to find, once for
# bindings, kotlin and swift. `tests/run.sh rust` builds the same files with the same features. Sets `target`, and `native`,
# the folder of the library. PROFILE=ship takes the library as phones get it, which builds longer. `packages`, where it is set, is what cargo
# builds in the workspace's place.
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
profile=${PROFILE:-test}
native=$target/$profile
[ "$profile" != test ] || native=$target/debug
[ -n "${packages+set}" ] || packages=("${workspace[@]}")
cargo build --quiet --locked --profile "$profile" "${packages[@]}" --lib --example expected

# expected FILE
expected() {
    mkdir -p "$(dirname "$1")"
    "$native/examples/expected" tests/recordings/broad_34_attached_magnet_3cm.csv.gz tests/vectors >"$1"
}
