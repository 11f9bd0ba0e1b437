#!/usr/bin/env python3
"""The page in headless Chromium: `web/tests/test_page.py PAGE.html MAGCOMP OUT`. MAGCOMP is the native command; pictures of the page go to OUT."""

import gzip
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import urllib.parse
import zipfile

from browser import Browser

page, command, out = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])
recordings = pathlib.Path(__file__).resolve().parents[2] / "tests/recordings"
recording = recordings / "broad_34_attached_magnet_3cm.csv.gz"
url = page.as_uri()
CLOCK = {"ns"}  # columns that the page's time, 0, is in


def shown(browser, name):
    return browser.run(f"!document.getElementById({json.dumps(name)}).hidden")


def text(browser, name):
    return browser.run(f"document.getElementById({json.dumps(name)}).textContent")


def saved(browser, name):
    """What a link saves."""
    return browser.run(f"savedText({json.dumps(name)})")


def replayed(browser, *paths):
    """Gives files and waits for what comes of them: the report, or why not."""
    browser.run("document.getElementById('done').hidden = document.getElementById('refused').hidden = true")
    browser.give(*paths)
    browser.until("!document.getElementById('done').hidden || !document.getElementById('refused').hidden")
    return text(browser, "why") if shown(browser, "refused") else None


def native(folder, *arguments):
    files = {name: folder / name for name in ("readings.csv", "calibration.json")}
    call = [command, "replay", *arguments, "--output", files["readings.csv"], "--calibration", files["calibration.json"]]
    subprocess.run([*call, "--report", folder / "report"], check=True, stdout=subprocess.DEVNULL)
    return files["readings.csv"].read_text(), files["calibration.json"].read_text()


def rows_of(csv):
    lines = [line.split(",") for line in csv.splitlines()]
    keep = [index for index, name in enumerate(lines[0]) if name not in CLOCK]
    return [[line[index] for index in keep] for line in lines]


def worst(one, other):
    """The largest difference of two tables of numbers, relative to 1 or the number; texts must be equal."""
    assert len(one) == len(other) and one[0] == other[0], (len(one), len(other))
    largest = 0.0
    for mine, yours in zip(one[1:], other[1:]):
        for a, b in zip(mine, yours):
            if a != b:
                largest = max(largest, abs(float(a) - float(b)) / max(1.0, abs(float(b))))
    return largest


# what the page saves is a blob, whose text the page may not fetch: it is kept where the link is made
KEEP = """
window.kept = {};
const made = URL.createObjectURL.bind(URL);
URL.createObjectURL = (blob) => { const url = made(blob); window.kept[url] = blob; return url; };
window.savedText = (name) => window.kept[document.getElementById(name).href].text();
"""


def a_real_recording(browser, folder):
    browser.open(url)
    assert replayed(browser, recording) is None
    readings, calibration = native(folder, recording)
    off = worst(rows_of(saved(browser, "readings")), rows_of(readings))
    assert off < 1e-6, f"the page's readings differ from the native ones by {off}"
    mine, yours = json.loads(saved(browser, "calibration")), json.loads(calibration)
    assert mine["recording"] == yours["recording"] and mine.keys() == yours.keys()
    for key in ("soft_iron", "hard_iron_ut"):
        assert all(abs(a - b) < 1e-6 * max(1, abs(b)) for a, b in zip(mine[key], yours[key])), key
    report = saved(browser, "saved")
    for word in ("heading", "total field", "<iframe srcdoc=", "data:image/svg+xml", f"magcomp replay {recording.name} --report"):
        assert word in report, f"the report lacks {word}"
    assert ">push, " not in report, "there is no clock"
    # it is shown, with pictures and a sphere that was drawn
    inside = "document.getElementById('report').contentDocument"
    browser.until(f"{inside}.querySelector('iframe').contentDocument?.readyState === 'complete'")
    browser.until(f"[...{inside}.images].every((image) => image.complete && image.naturalWidth > 0)")
    drawn = f"{inside}.querySelector('iframe').contentDocument"
    assert browser.run(f"{drawn}.getElementById('title').textContent.length > 0"), "the sphere's script did not run"
    print(f"  {len(readings.splitlines()) - 1} readings as native ones, to {off:.1e}")
    # the summary's numbers are those of the native report, but for the times
    whole = (folder / "report/index.html").read_text()
    table = lambda html: [line for line in html.splitlines() if line.startswith("<tr><td>") and ">push, " not in line]
    assert table(report) == table(whole), "the page's summary differs from the native one"
    # so are its pictures: their texts and how many lines they have
    drawn = [urllib.parse.unquote(it) for it in re.findall(r'src="data:image/svg\+xml,([^"]*)"', report)]
    names = re.findall(r'<img src="([a-z_]*.svg)"', whole)
    assert len(drawn) == len(names) == 3
    for name, picture in zip(names, drawn):
        svg = (folder / "report" / name).read_text()
        shape = lambda it: (re.findall(r"<text.*?</text>", it, re.DOTALL), it.count("<"))
        assert shape(picture) == shape(svg), f"{name} differs from the native one"
        print(f"  {name}: {'as the native one, byte for byte' if picture == svg else 'as the native one, but for digits'}")


def a_session(browser, folder):
    """A zip of Sensor Logger, with a name that must not become markup, and a place."""
    name = "<img src=x onerror=alert(1)> & so.zip"
    lines = gzip.open(recording, "rt").read().splitlines()[1:]
    start = 1_700_000_000_000_000_000
    sensors = {"MagnetometerUncalibrated": 1, "AccelerometerUncalibrated": 4, "GyroscopeUncalibrated": 7}
    with zipfile.ZipFile(folder / name, "w", zipfile.ZIP_DEFLATED) as packed:
        for sensor, first in sensors.items():
            rows = ["time,seconds_elapsed,z,y,x"]
            for line in lines:
                cells = line.split(",")
                x, y, z = cells[first : first + 3]
                rows.append(f"{start + round(float(cells[0]) * 1e9)},{cells[0]},{z},{y},{x}")
            packed.writestr(f"{sensor}.csv", "\n".join(rows))
    browser.open(url)
    browser.run("document.getElementById('place').value = '45.19, 5.73'")
    assert replayed(browser, folder / name) is None, text(browser, "why")
    readings, _ = native(folder, folder / name, "--place", "45.19,5.73")
    mine = saved(browser, "readings")
    assert "true_heading_deg" in mine.splitlines()[0]
    off = worst(rows_of(mine), rows_of(readings))
    assert off < 1e-6, off
    inside = "document.getElementById('report').contentDocument"
    browser.until(f"{inside}.querySelector('h1') !== null")
    assert browser.run(f"{inside}.querySelector('h1').textContent") == f"{name} replayed"
    browser.run("document.getElementById('place').value = 'Grenoble'")
    assert "expected LAT,LON" in replayed(browser, folder / name)


def the_example(browser, folder):
    """One click: a magnet comes, and what it came to is on the screen, has the focus and is told to a screen reader."""
    for width in (1200, 400):
        browser.open(url, width)
        browser.run("document.getElementById('example').click()")
        browser.until("document.getElementById('verdict').textContent !== ''")
        assert browser.run("document.activeElement.id") == "outcome"
        assert browser.run("document.getElementById('outcome').getAttribute('role')") == "status"
        top, high = (browser.run(f"document.getElementById('verdict').getBoundingClientRect().{it}") for it in ("top", "bottom"))
        assert 0 <= top and high <= browser.run("innerHeight"), f"at {width} pixels the verdict is at {top} to {high}"
        inside = browser.run("document.getElementById('report').contentDocument.body.textContent")
        [moment] = re.findall(r"device changed at (\d+\.\d) s", inside)
        assert 44.5 < float(moment) < 46.5, inside[:400]
        assert browser.run("document.documentElement.scrollWidth <= innerWidth"), f"{width}: the report is too wide"
        browser.picture(out / f"example-{width}.png", 1000)
    links = browser.run("[...document.querySelectorAll('.lead a')].map((link) => link.href)")
    assert len(links) == 2 and all(link.startswith("https://") for link in links), links


def wrong_files(browser, folder):
    browser.open(url)
    empty, picture, text_file, cut, parquet = (folder / n for n in ("empty.csv", "a.png", "notes.txt", "cut.csv.gz", "a.parquet"))
    empty.write_bytes(b"")
    picture.write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 20)
    text_file.write_text("dear diary\n" * 50)
    cut.write_bytes(recording.read_bytes()[:20_000])
    parquet.write_bytes(b"PAR1" + bytes(100) + b"PAR1")
    damaged = folder / "damaged.zip"
    damaged.write_bytes(b"PK\x03\x04" + bytes(range(256)) * 9)
    for path, says in (
        (empty, "nothing in it"),
        (picture, "no text file"),
        (text_file, "notes.txt"),
        (parquet, "this build does not read Parquet and Arrow"),
        (damaged, "damaged.zip"),
    ):
        why = replayed(browser, path)
        assert why is not None and says in why and "\n" not in why, f"{path.name}: {why}"
        assert not shown(browser, "running") and shown(browser, "choose")
    # a recording that is cut off gives what precedes the cut, and says so; and the page goes on
    assert replayed(browser, cut) is None
    told = browser.run("document.getElementById('warnings').textContent + document.getElementById('report').srcdoc")
    assert "cut off" in told, told[:400]
    assert replayed(browser, recording) is None


def large_files(browser, folder):
    least = 100e6 if os.environ.get("MAGCOMP_NIGHT") else 20e6
    lines = gzip.open(recording, "rt").read().splitlines(keepends=True)
    cells = [line.rstrip("\n").split(",", 1) for line in lines[1:]]
    large, period, shift = folder / "large.csv", float(cells[-1][0]) - float(cells[0][0]) + 0.02, 0.0
    with open(large, "w") as file:
        file.write(lines[0])
        while file.tell() < least:
            file.writelines(f"{float(time) + shift:.6f},{rest}\n" for time, rest in cells)
            shift += period
    browser.open(url)
    # cancel ends it, and the page takes the next
    browser.give(large)
    browser.until("document.getElementById('doing').textContent.startsWith('Replaying')")
    assert shown(browser, "running")
    share = browser.run("document.getElementById('bar').value")
    browser.until(f"document.getElementById('bar').value > {share}")
    browser.run("document.getElementById('cancel').click()")
    assert shown(browser, "choose") and not shown(browser, "running") and not shown(browser, "done")
    browser.run("new Promise((done) => setTimeout(done, 500))")
    assert not shown(browser, "done") and not shown(browser, "refused"), "it went on"
    begun = time.monotonic()
    assert replayed(browser, large) is None, text(browser, "why")
    took = time.monotonic() - begun
    size = browser.run("window.kept[document.getElementById('readings').href].size")
    assert size > least, size
    native_begun = time.monotonic()
    native(folder, large)
    native_took = time.monotonic() - native_begun
    rows = round(shift / period) * len(cells)
    print(f"  {large.stat().st_size / 1e6:.0f} MB, {rows} samples, replayed in {took:.0f} s, by the command in {native_took:.0f} s; {size / 1e6:.0f} MB of readings")
    # a file that is too large is refused before it is read
    huge = folder / "huge.csv"
    with open(huge, "wb") as file:
        file.truncate(600 * 2**20)
    assert "600 MiB; a page reads 512 MiB at most" in replayed(browser, huge)


def pictures(browser, folder):
    for width in (1200, 400):
        for dark in (False, True):
            browser.open(url, width, dark)
            name = f"{width}-{'dark' if dark else 'light'}"
            assert browser.run("document.documentElement.scrollWidth <= innerWidth"), f"{name}: the page is too wide"
            browser.picture(out / f"{name}-begin.png", 800)
            assert replayed(browser, recording) is None
            inside = "document.getElementById('report').contentDocument"
            browser.until(f"{inside}?.images.length > 0 && [...{inside}.images].every((image) => image.complete)")
            browser.run("new Promise((done) => setTimeout(done, 500))")
            assert browser.run("document.documentElement.scrollWidth <= innerWidth"), f"{name}: the report is too wide"
            high = browser.run(f"{inside}.documentElement.scrollHeight")
            assert high <= browser.run("document.getElementById('report').clientHeight"), f"{name}: the report is cut"
            browser.picture(out / f"{name}.png", 3400)


def main():
    out.mkdir(parents=True, exist_ok=True)
    browser = Browser()
    try:
        browser.call("Page.addScriptToEvaluateOnNewDocument", source=KEEP)
        for test in (a_real_recording, a_session, the_example, wrong_files, large_files, pictures):
            print(f"{test.__name__.replace('_', ' ')}", flush=True)
            with tempfile.TemporaryDirectory() as folder:
                test(browser, pathlib.Path(folder))
        asked = [address for address in browser.asked_for() if not address.startswith(("file:", "blob:", "data:", "about:"))]
        assert not asked, f"the page asked for {asked}"
        assert not browser.complaints(), browser.complaints()
        # the policy forbids a network: a page that tries is refused
        browser.open(url)
        tried = browser.run("fetch('https://example.org/').then(() => 'sent', () => 'refused')")
        assert tried == "refused" and any("Content Security Policy" in it for it in browser.complaints()), browser.complaints()
    finally:
        browser.close()


main()
