#!/usr/bin/env bash
# The page: builds it, and opens it from a folder in headless Chromium (web/tests): a real recording, a session, wrong files, 20 MB (100 with MAGCOMP_NIGHT=1),
# cancel, at 1200 and 400 pixels, with the command `magcomp` beside it. Pictures of it are in target/web-test. Then the TypeScript of docs/FRAMEWORKS.md.
# `tests/web.sh`, also `tests/run.sh web`.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
need web "${rust_tools[@]}" python3:python3 chromium:chromium npm:npm
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
# React's own types, and as much of React Native's as the page uses: its package has 200 MB
types=$target/web-test/types
mkdir -p "$types"
npm install --prefix "$types" --silent --no-save --no-package-lock typescript@5.9.3 @types/react@19.1.17 csstype@3.1.3
sed -n '/^```ts$/,/^```$/p' docs/FRAMEWORKS.md | sed '1d;$d' >"$types/heading.ts"
cat >"$types/react-native.d.ts" <<'TYPES'
declare module 'react-native' {
  export const NativeModules: { [name: string]: any };
  export class NativeEventEmitter {
    constructor(nativeModule?: any);
    addListener(event: string, heard: (data: any) => void): { remove(): void };
  }
}
TYPES
"$types/node_modules/.bin/tsc" --noEmit --strict --skipLibCheck --module esnext --moduleResolution bundler "$types/heading.ts" "$types/react-native.d.ts"
cargo fmt --manifest-path web/Cargo.toml --check
web/build.sh "$target/web-test/magcomp.html"
bytes=$(gzip -9 -c "$target/web-test/magcomp.html" | wc -c)
[ "$bytes" -lt 1500000 ] || { echo "web: the page has $bytes bytes gzipped, 1500000 or more" >&2; exit 1; }
. tests/native.sh
# --example: with the features that the tests' build has given to the crates they share
cargo build --quiet --locked --profile "$profile" "${workspace[@]}" --bin magcomp --example expected
python3 -B web/tests/test_page.py "$target/web-test/magcomp.html" "$native/magcomp" "$target/web-test"
echo "web: passed; $bytes bytes gzipped"
