#!/usr/bin/env python3
"""The notices of others' code in the Android library: every crate that is linked into it, with its licence's text.

Writes android/aar/THIRD-PARTY-NOTICES, which the AAR carries; with --check, fails when the committed file differs.
"""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FILE = ROOT / "android/aar/THIRD-PARTY-NOTICES"
TARGET = "aarch64-linux-android"

HEAD = """The native library of magcomp holds code of others. Each part is listed with its licence; where it offers several, the text is that of
the one taken. Rust's own library is linked too: Copyright (c) The Rust Project Contributors, MIT or Apache-2.0, the MIT text as below.
Kotlin's library, the coroutines and JNA are dependencies of their own, which an app's build brings along with their notices.
The source of a part under MPL-2.0 is that of its crate, unchanged; the licence is at https://www.mozilla.org/MPL/2.0/.
"""


def linked():
    """The packages that end up in the library, with its own features: no macros, nothing for builds and tests alone."""
    command = ["cargo", "tree", "--locked", "-p", "magcomp-ffi", "--target", TARGET, "--edges", "normal,no-proc-macro", "--prefix", "none"]
    lines = run(*command, "--format", "{p}").splitlines()
    names = {tuple(line.split()[:2]) for line in lines if line}
    packages = json.loads(run("cargo", "metadata", "--locked", "--format-version", "1"))["packages"]
    found = [p for p in packages if (p["name"], "v" + p["version"]) in names and p["source"]]
    return sorted(found, key=lambda p: (p["name"], p["version"]))


def run(*command):
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout


def text_of(package):
    """The licence's file: MIT's where there is a choice, as the shortest."""
    folder = Path(package["manifest_path"]).parent
    names = sorted(f.name for f in folder.iterdir() if f.name.upper().startswith(("LICENSE", "LICENCE", "COPYING")) and f.is_file())
    for want in ("MIT", "LICENSE", "LICENCE", "COPYING"):
        for name in names:
            if want in name.upper():
                return (folder / name).read_text().strip()
    return None


def main():
    texts, without = {}, []
    for package in linked():
        name = f"{package['name']} {package['version']} ({package['license']})"
        text = text_of(package)
        if text is None:
            without.append(name + ", by " + ", ".join(package["authors"] or ["its contributors"]))
        else:
            texts.setdefault(text, []).append(name)
    parts = [HEAD]
    for text, names in sorted(texts.items(), key=lambda item: item[1]):
        parts.append("\n".join(names) + "\n\n" + text + "\n")
    if without:
        parts.append("Without a text of their own:\n" + "\n".join(without) + "\n")
    written = ("\n" + "-" * 80 + "\n\n").join(parts)
    written = "\n".join(line.rstrip() for line in written.splitlines()) + "\n"
    if "--check" in sys.argv:
        if not FILE.exists() or FILE.read_text() != written:
            sys.exit(f"notices: {FILE.relative_to(ROOT)} is out of date; run tests/notices.py and commit")
        print(f"notices: {sum(map(len, texts.values())) + len(without)} crates, up to date")
    else:
        FILE.write_text(written)


main()
