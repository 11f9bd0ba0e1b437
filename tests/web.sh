#!/usr/bin/env bash
# The page: builds it, and opens it from a folder in headless Chromium (web/tests): a real recording, a session, wrong files, 20 MB (100 with MAGCOMP_NIGHT=1),
# cancel, at 1200 and 400 pixels, with the command `magcomp` beside it. `tests/web.sh`, also `tests/run.sh web`. Pictures of it are in target/web-test.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
need web "${rust_tools[@]}" python3:python3 chromium:chromium
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
cargo fmt --manifest-path web/Cargo.toml --check
web/build.sh "$target/web-test/magcomp.html"
bytes=$(gzip -9 -c "$target/web-test/magcomp.html" | wc -c)
[ "$bytes" -lt 1500000 ] || { echo "web: the page has $bytes bytes gzipped, 1500000 or more" >&2; exit 1; }
. tests/native.sh
# --example: with the features that the tests' build has given to the crates they share
cargo build --quiet --locked --profile "$profile" "${workspace[@]}" --bin magcomp --example expected
python3 -B web/tests/test_page.py "$target/web-test/magcomp.html" "$native/magcomp" "$target/web-test"
echo "web: passed; $bytes bytes gzipped"
