#!/usr/bin/env bash
# The public API, line by line, as it was agreed on: `tests/api.sh rust` compares that of the crate `magcomp` with rust/api.txt, `tests/api.sh swift` that of
# the Swift package with ios/api.txt, from what tests/swift.sh built last. With --write it takes the new one over, where a change is meant. Kotlin's is
# android/library/api/library.api (ApiTest), C's c/abi.txt (tests/c.sh). `rust` needs Rust's nightly, whose rustdoc writes JSON.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/need.sh
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

rust() {
    need_cargo api cargo-public-api@0.52.0 >&2
    rustup which --toolchain nightly rustdoc >/dev/null 2>&1 || { echo "api: missing: Rust's nightly: rustup toolchain install nightly" >&2; exit 1; }
    # as others take the crate: without `exhaustive`
    cargo +nightly public-api --package magcomp --target-dir "$target/api" -ss
}

swift() {
    need api python3:python3
    python3 - "$target/swift/symbols" <<'PYTHON'
import json, pathlib, re, sys

lines, conforms = set(), {}
graphs = [json.loads(file.read_text()) for file in pathlib.Path(sys.argv[1]).glob("Magcomp*.symbols.json")]
graphs = [graph for graph in graphs if graph["module"]["name"] == "Magcomp"]
# every type has them, and newer compilers more of them
implied = {"Swift.Copyable", "Swift.Escapable", "Swift.SendableMetatype"}
for relation in (relation for graph in graphs for relation in graph["relationships"]):
    name = relation.get("targetFallback", relation["target"])
    if relation["kind"] in ("conformsTo", "inheritsFrom") and name not in implied:
        conforms.setdefault(relation["source"], set()).add(name.removeprefix("Swift."))
for symbol in (symbol for graph in graphs for symbol in graph["symbols"]):
    precise = symbol["identifier"]["precise"]
    if "::SYNTHESIZED::" not in precise and symbol["accessLevel"] in ("public", "open"):
        declaration = "".join(part["spelling"] for part in symbol["declarationFragments"])
        also = ", ".join(sorted(conforms.get(precise, ())))
        lines.add(" ".join(f"{'.'.join(symbol['pathComponents'])}: {declaration}{also and ' // ' + also}".split()))
if not any(line.startswith("Compass.") for line in lines):
    sys.exit(f"api: {sys.argv[1]} has no symbols of the package; run tests/swift.sh build")
names = {line.split(":")[0].split("(")[0] for line in lines}
# SwiftUI's views too, which Linux does not compile
for file in pathlib.Path("ios/Sources/Magcomp").glob("*.swift"):
    names.update(re.findall(r"^public (?:final class|class|struct|enum|protocol) (\w+)", file.read_text(), re.M))
elsewhere = [line.split(":")[1].split() for line in pathlib.Path("ios/Tests/Consumer/names.txt").read_text().splitlines() if line[:1] != "#"]
clash = {name for name in names for theirs in elsewhere if name in theirs}
clash |= {name for name in names if re.match("(AR|CA|CG|CL|CM|MK|MLN|NS|RK|SCN|UI)[A-Z]", name)}
if clash:
    sys.exit(f"api: names that an app has from elsewhere (ios/Tests/Consumer/names.txt): {sorted(clash)}")
print("\n".join(sorted(lines)))
PYTHON
}

case "$#:${1:-}:${2:-}" in
    1:rust: | 2:rust:--write) agreed=rust/api.txt ;;
    1:swift: | 2:swift:--write) agreed=ios/api.txt ;;
    *) echo "usage: tests/api.sh rust|swift [--write]" >&2; exit 2 ;;
esac
"$1" >"$work/api.txt"
if [ "${2:-}" = --write ]; then
    cp "$work/api.txt" "$agreed"
elif ! diff "$agreed" "$work/api.txt"; then
    echo "api: $agreed differs (<) from what there is (>); if the change is meant, run tests/api.sh $1 --write and commit" >&2
    exit 1
fi
echo "api: $1, $(wc -l <"$agreed") lines"
