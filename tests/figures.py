#!/usr/bin/env python3
"""Figures of the pages. `tests/figures.py` compares those that one page takes from another, at once: LIMITS's with EVALUATION's, README's with COMPARISON's
and LIMITS's. `tests/figures.py commands` runs the commands beside figures too, for about ten minutes: before a release, with the command built
(`cargo build --release`), or with MAGCOMP naming it. `tests/figures.py comparison [PHONES]` runs COMPARISON's two comparisons alone; PHONES is what
`benchmarks/convert.py smartphones` wrote, and without it the phones' tables stay. With `--write` each corrects the pages."""

import json
import os
import re
import subprocess
import sys
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NUMBER = r"[+-]?\d+(?:\.\d+)?"


def cells(row):
    return [cell.strip() for cell in row.strip().strip("|").split("|")]


class Pages:
    """The pages as they are read, and as they should be."""

    def __init__(self):
        self.texts, self.wrong, self.changed = {}, [], set()

    def text(self, name):
        if name not in self.texts:
            self.texts[name] = (ROOT / name).read_text()
        return self.texts[name]

    def expect(self, name, old, new, what):
        """`old` of page `name` should read `new`."""
        if old != new:
            shorten = lambda text: textwrap.shorten(text, 300)
            self.wrong.append(f"{name}: {what}: {shorten(old)!r} should be {shorten(new)!r}")
            self.texts[name] = self.text(name).replace(old, new, 1)
            self.changed.add(name)

    def sentence(self, name, template, values):
        """A place of page `name` that reads as `template`, its {} numbers: those are `values` as the template formats them."""
        parts = re.split(r"(\{[^}]*\})", template)
        of = lambda part: r"\s+".join(map(re.escape, re.split(r"\s+", part)))
        pattern = "".join(f"({NUMBER}|never)" if part.startswith("{") else of(part) for part in parts)
        found = list(re.finditer(pattern, self.text(name)))
        if len(found) != 1:
            self.wrong.append(f"{name}: {len(found)} places read {template!r}")
            return
        found, formats = found[0], [part for part in parts if part.startswith("{")]
        new, end = "", found.start()
        for k, (value, form) in enumerate(zip(values, formats, strict=True), 1):
            shown = "never" if value is None else value if isinstance(value, str) else form.format(value)
            new += self.text(name)[end : found.start(k)] + shown
            end = found.end(k)
        new += self.text(name)[end : found.end()]
        self.expect(name, found.group(), new, template)


def evaluation(pages):
    """EVALUATION's lines: (title of the part, name) -> cells."""
    lines, title = {}, None
    for row in pages.text("docs/EVALUATION.md").splitlines():
        if row.startswith("## "):
            title = row[3:]
        elif row.startswith("| "):
            lines[title, cells(row)[0]] = cells(row)
    return lines


def limits(pages):
    """LIMITS's table takes its figures from the line of EVALUATION that its last column names."""
    lines, part = evaluation(pages), ""
    alone = "Magnetometer and accelerometer, no gyroscope"
    for row in pages.text("docs/LIMITS.md").splitlines():
        part = row[3:] if row.startswith("## ") else part
        if not row.startswith("| ") or row.startswith("| situation"):
            continue
        situation, *_, helps, name = cells(row)
        is_alone = part == "Without a gyroscope"
        found = [line for (title, own), line in lines.items() if own == name and (title == alone) == is_alone]
        if len(found) != 1:
            pages.wrong.append(f"docs/LIMITS.md: EVALUATION has {len(found)} lines {name!r}")
            continue
        answered, error, worst, within = (found[0][k] for k in (1, 4, 5, 7))
        says = "-" if within == "-" else "yes" if int(within) >= 95 else "mostly" if int(within) >= 85 else "no"
        pages.expect("docs/LIMITS.md", row, f"| {' | '.join([situation, error, worst, answered, says, helps, name])} |", situation)


def readme(pages):
    """README's table is median and worst of COMPARISON's."""
    compared, title = {}, ""
    for row in pages.text("docs/COMPARISON.md").splitlines():
        title = row[4:].split(":")[0] if row.startswith("### ") else title
        if row.startswith("| "):
            compared[title, cells(row)[0]] = cells(row)
    figures = lambda cell: [part.strip() for part in cell.split("/")]
    north = []
    for name, title in [("in a quiet room, 20 recordings", "Quiet room"), ("running, 6", "Running"),
                        ("past boards with magnets, 19", "Past boards with magnets")]:
        methods = [compared[title, method] for method in ("the system's field", "VQF on the system's field", "magcomp: heading")]
        pairs = [value for method in methods for value in (figures(method[1])[0], figures(method[1])[2])]
        pages.sentence("README.md", f"| {name} | {{}}, worst {{}} | {{}}, worst {{}} | **{{}}**, worst {{}} |", pairs)
        north.append(figures(methods[2][2])[0])
    pages.sentence("README.md", "With it left in, magcomp has {}, {} and {}.", north)
    alone = figures(compared["Past boards with magnets", "magcomp, magnetometer alone: corrected sample"][1])
    pages.sentence("README.md", "errors of {} degrees;", alone[:1])
    pages.sentence("docs/LIMITS.md", "the heading is of no use: {} degrees off, {} at worst", [alone[0], alone[2]])
    car = evaluation(pages)["Carried phones: places", "in a hand, a car of 30 uT closes at 30 s"]
    pages.sentence("README.md", "in a car without GNSS: {} degrees in a hand", car[4:5])


def magcomp(*arguments):
    command = os.environ.get("MAGCOMP") or os.environ.get("CARGO_TARGET_DIR", "target") + "/release/magcomp"
    line = [str(Path(ROOT, command)), *arguments, "--json"]
    print("figures: magcomp", *arguments, flush=True)
    return json.loads(subprocess.run(line, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout)


def half(result):
    return next(one for one in result["normalisations"] if one["normalisation"] == "HalfRange")


def even(result):
    return next(one for one in result["normalisations"] if one["normalisation"] != "HalfRange")


def steady(one):
    return [parameter["steady_percent"]["mean"] for parameter in one["parameters"]]


def slowest(one):
    slow = [parameter for parameter in one["parameters"] if parameter["transient_samples"] is not None]
    slow = max(slow, key=lambda parameter: parameter["transient_samples"])
    return slow["transient_samples"], slow["transient_sd"]


def answer(result, name):
    return next(answer for answer in result["answers"] if answer["name"] == name)


def headline(pages):
    found = magcomp("demo", "--runs", "1", "--report", os.environ.get("TMPDIR", "/tmp") + "/magcomp-figures")["headline"]
    three = [found["raw_deg"], found["papers_deg"], found["magcomp_deg"]]
    pages.sentence("README.md", "The raw heading is {:.0f} degrees off, that of [the paper's method](docs/dev/PAPER.md), which magcomp began from, {:.0f}, "
                   "magcomp's {:.1f} (rms;", three)
    pages.sentence("docs/COMPARISON.md", "leaves the raw heading {:.0f} degrees off, the paper's {:.0f}, VQF's", three[:2])


def steps(pages):
    """COMPARISON's seconds beside the paper's method with magcomp's checks."""
    for motion in ("tumble", "walk"):
        arguments = ["step", "--motion", motion, "--runs", "20"]
        found = magcomp(*arguments)
        both = [answer(found, name)["below_2_deg"] for name in ("windowed, c", "aided, c")]
        values = [one[key] for one in both for key in ("median", "worst")]
        pages.sentence("docs/COMPARISON.md", f"| `magcomp {' '.join(arguments)}` | {{:.1f}} | {{:.1f}} | {{:.1f}} | {{:.1f}} |", values)


def paper(pages):
    page = "docs/dev/PAPER.md"
    usual = half(magcomp("step", "--normalisation", "half-range"))
    algebraic = half(magcomp("step", "--normalisation", "half-range", "--residual", "algebraic"))
    pages.sentence(page, "`magcomp step --normalisation half-range`: sigma_T {:.3f}, N {:.0f}", [usual["sigma_t"]["mean"], usual["window"]["mean"]])
    pages.sentence(page, "{:.0f} +- {:.0f} for the slowest parameter", slowest(usual))
    pages.sentence(page, "whose window is not cut: {:.0f} +- {:.0f}", slowest(algebraic))
    pages.sentence(page, "hardly matters: {:.2f} and {:.2f} %", [max(steady(usual)), max(steady(algebraic))])
    kept, after = usual["kept"], usual["after"]
    pages.sentence(page, "| {:.1f} and {:.1f} deg, mean of the peaks |", [kept["azimuth_deg"]["mean"], kept["elevation_deg"]["mean"]])
    angles = [after[angle][which] for which in ("mean", "max") for angle in ("azimuth_deg", "elevation_deg")]
    pages.sentence(page, "after the transient {:.1f} and {:.1f} deg mean, {:.1f} and {:.1f} deg at most", angles)
    longer = half(magcomp("step", "--normalisation", "half-range", "--n-max", "4000"))
    pages.sentence(page, "--n-max 4000`: N {:.0f}, longest transient {:.0f} samples, worst steady error {:.1f} % instead of {:.1f} %",
                   [longer["window"]["mean"], slowest(longer)[0], max(steady(longer)), max(steady(usual))])
    planar = half(magcomp("step", "--motion", "planar", "--normalisation", "half-range", "--runs", "20"))
    pages.sentence(page, "--runs 20`: sigma_T {:.2f} +- {:.2f}; errors of {:.0f} to {:.0f} % after the step",
                   [planar["sigma_t"]["mean"], planar["sigma_t"]["sd"], min(steady(planar)), max(steady(planar))])
    still = half(magcomp("step", "--motion", "still", "--normalisation", "half-range", "--runs", "10"))
    pages.sentence(page, "--runs 10`: {:.2f} +- {:.2f}, nothing followed", [still["sigma_t"]["mean"], still["sigma_t"]["sd"]])
    stroll = half(magcomp("step", "--motion", "stroll", "--normalisation", "half-range", "--runs", "3"))
    pages.sentence(page, "strolling leaves {:.0f} to {:.0f} %", [min(steady(stroll)), max(steady(stroll))])
    bound = magcomp("crb", "--runs", "100", "--snr", "35,40")["rows"]
    ratios = [ratio for row in bound for ratio in row["corrected"]]
    diagonal = lambda snr: [row["algebraic"][0] for row in bound if row["snr_db"] == snr]
    pages.sentence(page, "corrected: {:.2f} to {:.2f} of the bound in all groups. (10) as written, in the diagonal of M: {:.2f} to {:.2f} at 40 dB and {:.2f} to "
                   "{:.2f} at 35 dB", [f(values) for values in (ratios, diagonal(40.0), diagonal(35.0)) for f in (min, max)])
    usual_page = "docs/dev/METHOD-PAPER.md"
    pages.sentence(usual_page, "| sigma_T, N | {:.2f}, {:.0f} |", [usual["sigma_t"]["mean"], usual["window"]["mean"]])
    pages.sentence(usual_page, "| after {:.0f} +- {:.0f} samples", slowest(usual))
    pages.sentence(usual_page, "| {:.0f} +- {:.0f} samples | |", slowest(algebraic))
    pages.sentence(usual_page, "| {:.2f} %, with the algebraic residual {:.2f} %", [max(steady(usual)), max(steady(algebraic))])
    small = magcomp("step", "--set", "small")
    pages.sentence(usual_page, "| {:.1f} % (`HalfRange`), {:.1f} % (`EvenSphere`)", [max(steady(half(small))), max(steady(even(small)))])


def aided(pages):
    """METHOD-AIDED's table of a bad gyroscope."""
    poor = "--gyro-bias 5 --gyro-scale 1 --gyro-late 10 --rate 25 --seed 2001".split()
    for motion, name in (("tumble", "tumbling"), ("walk", "walking")):
        for snr in (40, 30):
            noise = ["--snr", "30"] if snr == 30 else []
            found = magcomp("step", "--runs", "20", "--motion", motion, *poor, *noise)
            seconds = answer(found, "aided, c")["below_2_deg"]
            within = next(one for one in found["methods"] if one["method"] == "Aided")["line"]["within"]
            pages.sentence("docs/dev/METHOD-AIDED.md", f"| {name}, {snr} dB | {{:.1f}} s | {{:.1f}} s | {{:.0f}} %, {{:.0f}} % |",
                           [seconds["median"], seconds["worst"], 100 * within[0], 100 * within[1]])


def tables(folder, order):
    """What `compare` prints of a folder of recordings, as COMPARISON has it: the groups in this order."""
    command = os.environ.get("MAGCOMP") or os.environ.get("CARGO_TARGET_DIR", "target") + "/release/magcomp"
    line = [str(Path(ROOT, command)), "compare", "--recordings", str(folder), "--markdown"]
    print("figures: magcomp compare --recordings", Path(folder).name, flush=True)
    printed = subprocess.run(line, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    found = {}
    for title, rows, notes in re.findall(r"^([^|\n][^\n]*)\n\n((?:\|[^\n]*\n)+)\n?((?:[^|\n][^\n]*\n)*)", printed, re.MULTILINE):
        notes = " ".join(notes.split())
        notes = notes.split(" Rms of the heading error")[0].replace("*: the best.", "Bold: the best.")
        found[title[0].upper() + title[1:]] = rows + ("\n" + textwrap.fill(notes, 158, break_on_hyphens=False) + "\n" if notes else "")
    place = lambda title: next((k for k, begin in enumerate(order) if title.startswith(begin)), len(order))
    return "\n".join(f"### {title}\n\n{found[title]}" for title in sorted(found, key=place)) + "\n"


def comparison(pages, phones=None):
    page = "docs/COMPARISON.md"
    places = [("## A sensor with magnets", "\n## Phones", "tests/recordings", ["Median", "A magnet is put", "Nothing", "Past", "A magnet on"])]
    if phones is not None:
        places.append(("## Phones", "\nVQF starts from", phones, ["Median", "Quiet", "Running", "Past"]))
    for begin, end, folder, order in places:
        text = pages.text(page)
        first = text.index("\n### ", text.index(begin)) + 1
        old = text[first : text.index(end, first)]
        pages.expect(page, old, tables(Path(folder).resolve(), order).rstrip("\n") + "\n", begin)


def main():
    arguments = sys.argv[1:]
    writes = "--write" in arguments
    what, *phones = [argument for argument in arguments if argument != "--write"] or ["pages"]
    if what not in ("pages", "commands", "comparison") or len(phones) > (what == "comparison"):
        sys.exit(__doc__)
    pages = Pages()
    if what == "comparison":
        comparison(pages, *phones)
    parts = [limits, readme] + ([headline, steps, paper, aided] if what == "commands" else [])
    for part in parts:
        part(pages)
    for wrong in pages.wrong:
        print(f"figures: {wrong}", file=sys.stderr)
    if writes:
        for name in pages.changed:
            (ROOT / name).write_text(pages.text(name))
    sys.exit(1 if pages.wrong else 0)


main()
