#!/usr/bin/env python3
"""Makes one file of the page: `web/assemble.py MODULE.wasm PAGE.html`. What may run is named by its hash in the page's policy."""

import base64
import gzip
import hashlib
import html
import pathlib
import re
import sys

here = pathlib.Path(__file__).parent
replay = here.parent / "rust/magcomp-replay/src"
module, page = map(pathlib.Path, sys.argv[1:])


def hash_of(script):
    return f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'"


def example():
    """90 s of a recording without disturbance, as they are but for their times; from 45 s on a constant field of 27 uT is added: a magnet."""
    lines = gzip.open(here.parent / "tests/recordings/broad_01_slow_rotation_A.csv.gz", "rt").read().splitlines()
    begin_s, seconds, on_s, magnet_ut = 60.0, 90.0, 45.0, (18.0, -12.0, 16.0)
    rows = [lines[0]]
    for line in lines[1:]:
        cells = line.split(",")
        time_s = float(cells[0]) - begin_s
        if 0 <= time_s < seconds:
            field = [f"{float(cell) + (own if time_s >= on_s else 0):.3f}" for cell, own in zip(cells[1:4], magnet_ut)]
            rows.append(",".join([f"{time_s:.4f}", *field, *cells[4:]]))
    return gzip.compress("\n".join([*rows, ""]).encode(), 9, mtime=0)


parts = {name: (here / "page" / name).read_text() for name in ("page.css", "page.js", "worker.js")}
parts["example"] = base64.b64encode(example()).decode()
parts["report.css"] = (replay / "report.css").read_text()
parts["wasm"] = base64.b64encode(gzip.compress(module.read_bytes(), 9, mtime=0)).decode()
# the report has a cursor, and shows the sphere: their scripts are the same for every recording
[sphere] = re.findall(r"<script>(.*?)</script>", (replay / "draw/sphere.html").read_text(), re.DOTALL)
cursor = (replay / "report.js").read_text()
parts["policy"] = "; ".join(
    [
        "default-src 'none'",
        f"script-src 'wasm-unsafe-eval' {hash_of(parts['page.js'])} {hash_of(sphere)} {hash_of(cursor)}",
        "worker-src blob:",
        "style-src 'unsafe-inline'",
        "img-src data:",
        "base-uri 'none'",
        "form-action 'none'",
    ]
)
licences = [here.parent / "LICENSE-MIT", here.parent / "LICENSE-APACHE", here / "THIRD-PARTY-NOTICES"]
parts["licences"] = html.escape("\n".join(file.read_text() for file in licences))
frame = (here / "page/page.html").read_text()
page.parent.mkdir(parents=True, exist_ok=True)
page.write_text(re.sub(r"\{\{([a-z.]+)\}\}", lambda found: parts[found[1]], frame))
whole = len(gzip.compress(page.read_bytes(), 9))
print(f"{page}: {page.stat().st_size} bytes, {whole} gzipped; the module {module.stat().st_size}, {len(gzip.compress(module.read_bytes(), 9))} gzipped")
