#!/usr/bin/env python3
"""The notices of others' code in what is published: every crate that is linked into a library, with its licence's text.

Writes THIRD-PARTY-NOTICES in the folder of each product, which carries it; with --check, fails when a committed file differs. With
--parts FILE MANIFEST PACKAGE TARGET, fails when a CycloneDX file lacks a crate that is linked there.
"""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SYSTEMS = ["x86_64-unknown-linux-gnu", "aarch64-unknown-linux-gnu", "x86_64-apple-darwin", "aarch64-apple-darwin", "x86_64-pc-windows-msvc"]
# folder: manifest, package, targets, and what the notices say besides
PRODUCTS = {
    "android/aar": (
        "Cargo.toml",
        "magcomp-ffi",
        ["aarch64-linux-android"],
        "Kotlin's library, the coroutines and JNA are dependencies of their own, which an app's build brings along with their notices.\n",
    ),
    "c": ("Cargo.toml", "magcomp-c", SYSTEMS, ""),
    "ios": ("Cargo.toml", "magcomp-ffi", ["aarch64-apple-ios"], ""),
    "python": ("Cargo.toml", "magcomp-python", SYSTEMS, "NumPy is a dependency of its own, which an installer brings along with its notices.\n"),
    "web": ("web/Cargo.toml", "magcomp-web", ["wasm32-unknown-unknown"], ""),
}

HEAD = """The native library of magcomp holds code of others. Each part is listed with its licence; where it offers several, the text is that of
the one taken. Rust's own library is linked too: Copyright (c) The Rust Project Contributors, MIT or Apache-2.0, the MIT text as below.
"""
MPL = """The source of a part under MPL-2.0 is that of its crate, unchanged; the licence is at https://www.mozilla.org/MPL/2.0/.
"""


def linked(manifest, package, targets):
    """The packages that end up in the library, with its own features: no macros, nothing for builds and tests alone."""
    which = ["--locked", "--manifest-path", manifest]
    command = ["cargo", "tree", *which, "-p", package, "--edges", "normal,no-proc-macro", "--prefix", "none"]
    for target in targets:
        command += ["--target", target]
    lines = run(*command, "--format", "{p}").splitlines()
    names = {tuple(line.split()[:2]) for line in lines if line}
    packages = json.loads(run("cargo", "metadata", *which, "--format-version", "1"))["packages"]
    found = [p for p in packages if (p["name"], "v" + p["version"]) in names and p["source"]]
    return sorted(found, key=lambda p: (p["name"], p["version"]))


def run(*command):
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout


def text_of(package):
    """The licence's file: MIT's where there is a choice, as the shortest; all where several hold at once."""
    folder = Path(package["manifest_path"]).parent
    names = sorted(f.name for f in folder.iterdir() if f.name.upper().startswith(("LICENSE", "LICENCE", "COPYING")) and f.is_file())
    if " AND " in package["license"]:
        return "\n\n".join((folder / name).read_text().strip() for name in names)
    for want in ("MIT", "LICENSE", "LICENCE", "COPYING"):
        for name in names:
            if want in name.upper():
                return (folder / name).read_text().strip()
    return None


def notices(manifest, package, targets, own):
    texts, without = {}, []
    parts = linked(manifest, package, targets)
    for part in parts:
        name = f"{part['name']} {part['version']} ({part['license']})"
        text = text_of(part)
        if text is None:
            without.append(name + ", by " + ", ".join(part["authors"] or ["its contributors"]))
        else:
            texts.setdefault(text, []).append(name)
    written = [HEAD + own + (MPL if any("MPL" in part["license"] for part in parts) else "")]
    for text, names in sorted(texts.items(), key=lambda item: item[1]):
        written.append("\n".join(names) + "\n\n" + text + "\n")
    if without:
        written.append("Without a text of their own:\n" + "\n".join(without) + "\n")
    whole = ("\n" + "-" * 80 + "\n\n").join(written)
    return "\n".join(line.rstrip() for line in whole.splitlines()) + "\n", len(parts)


def check_parts(file, manifest, package, target):
    told = {(part["name"], part["version"]): part for part in json.loads(Path(file).read_text())["components"]}
    parts = linked(manifest, package, [target])
    for part in parts:
        if not told.get((part["name"], part["version"]), {}).get("licenses"):
            sys.exit(f"notices: {file} lacks {part['name']} {part['version']}, or its licence")
    if not parts:
        sys.exit(f"notices: {manifest} links nothing for {target}")
    print(f"notices: {Path(file).name}: {len(told)} parts, among them all {len(parts)} that are linked")


def main():
    if sys.argv[1:2] == ["--parts"]:
        return check_parts(*sys.argv[2:])
    for folder, product in PRODUCTS.items():
        file = ROOT / folder / "THIRD-PARTY-NOTICES"
        written, count = notices(*product)
        if "--check" not in sys.argv:
            file.write_text(written)
        elif not file.exists() or file.read_text() != written:
            sys.exit(f"notices: {file.relative_to(ROOT)} is out of date; run tests/notices.py and commit")
        print(f"notices: {folder}: {count} crates")


main()
