#!/usr/bin/env python3
"""Figures of the pages. `tests/figures.py` compares the pages with docs/data, and those figures that one page takes from another, at once.

With --write it corrects them. What runs the command needs it built (`cargo build --release`), or MAGCOMP naming it, and writes docs/data and pictures too:

    tests/figures.py evaluation --write                     docs/data/evaluation.csv: all situations, by the seeds that judge
    tests/figures.py comparison [PHONES PUT_ON] --write     docs/data/comparison.csv and magnets.csv: recordings. PHONES is what `benchmarks/convert.py smartphones`
                                                            wrote, PUT_ON what `benchmarks/convert.py magnet` made of it; FOLDER-NAME beside each has
                                                            the answers of `benchmarks/rivals.py NAME`. Without them the lines of phones stay
    tests/figures.py commands --write                       figures in the text that other commands print, for about ten minutes"""

import csv
import html
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import textwrap
from statistics import median
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NUMBER = r"[+-]?\d+(?:\.\d+)?"
EVALUATION, COMPARISON, MAGNETS = "docs/data/evaluation.csv", "docs/data/comparison.csv", "docs/data/magnets.csv"


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

    def replace(self, name, new):
        """The whole file `name` should read `new`."""
        old = self.text(name) if (ROOT / name).exists() else ""
        if old != new:
            self.wrong.append(f"{name}: is not what the command or its data give")
            self.texts[name] = new
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


    def table(self, name, after, rows):
        """The first table of page `name` below the line `after`, without its two head lines."""
        text = self.text(name)
        begin = text.find(f"\n{after}\n")
        found = re.compile(r"^\|[^\n]*\n\|-[^\n]*\n((?:\|[^\n]*\n)*)", re.MULTILINE).search(text, begin) if begin >= 0 else None
        if found is None:
            self.wrong.append(f"{name}: no table below {after!r}")
            return
        new = text[begin : found.start(1)] + "".join(f"| {' | '.join(row)} |\n" for row in rows)
        self.expect(name, text[begin : found.end()], new, after)


def data(pages, name):
    return list(csv.DictReader(pages.text(name).splitlines()))


def limits(pages):
    """LIMITS's table takes its figures from the line of docs/data/evaluation.csv whose name its last column has."""
    lines = data(pages, EVALUATION)
    for row in pages.text("docs/LIMITS.md").splitlines():
        if not row.startswith("| ") or row.startswith("| situation"):
            continue
        situation, *_, helps, name = cells(row)
        found = [line for line in lines if line["name"] == name.strip("`")]
        if len(found) != 1:
            pages.wrong.append(f"docs/LIMITS.md: {EVALUATION} has {len(found)} lines {name}")
            continue
        shown = [found[0][key] or "-" for key in ("error_median_deg", "error_worst_deg", "answered_percent")]
        within = found[0]["within_2_sigma_percent"]
        says = "-" if not within else "yes" if int(within) >= 95 else "mostly" if int(within) >= 85 else "no"
        pages.expect("docs/LIMITS.md", row, f"| {' | '.join([situation, *shown, says, helps, name])} |", situation)


# A line is bad when fewer of its errors lie within two sigmas, a lie lasts longer, or more changes are told that did not happen.
LEAST_WITHIN, MOST_LIE_S, MOST_FALSE_PER_H = 90, 1.0, 10
WORST = 20


def number(line, key):
    """A figure of a line; nothing where none was judged, and infinite where it was never reached."""
    cell = line[key]
    return None if cell == "" else float("inf") if cell == "never" else float(cell)


def evaluation_page(pages):
    """EVALUATION's groups, its worst lines and its counts."""
    page, lines = "docs/EVALUATION.md", data(pages, EVALUATION)
    groups = list(dict.fromkeys(line["group"] for line in lines))
    rows = []
    for group in groups:
        own = [line for line in lines if line["group"] == group]
        errors = [error for line in own if (error := number(line, "error_median_deg")) is not None]
        within = [share for line in own if (share := number(line, "within_2_sigma_percent")) is not None]
        shown = [f"{median(errors):.1f}", f"{max(errors):.1f}"] if errors else ["-", "-"]
        answered = [share for line in own if (share := number(line, "answered_percent")) is not None]
        rows.append([group.removeprefix("Carried phones: "), str(len(own)), f"{median(answered):.0f}" if answered else "-", *shown, f"{min(within):.0f}" if within else "-"])
    pages.table(page, "## Groups", rows)
    judged = [line for line in lines if line["error_median_deg"]]
    judged.sort(key=lambda line: -float(line["error_median_deg"]))
    keys = ("answered_percent", "error_median_deg", "error_worst_deg", "within_2_sigma_percent")
    pages.table(page, "## The twenty worst", [[line["situation"], *(line[key] or "-" for key in keys)] for line in judged[:WORST]])
    narrow = sum((number(line, "within_2_sigma_percent") or 100) < LEAST_WITHIN for line in judged)
    lies = sum(number(line, "lie_s") > MOST_LIE_S for line in lines)
    false = sum(number(line, "false_per_h") > MOST_FALSE_PER_H for line in lines)
    missed, due = (sum(int(line[key]) for line in lines) for key in ("missed", "due"))
    pages.sentence(page, "Of {:.0f} situations {:.0f} have a heading that is judged.", [len(lines), len(judged)])
    pages.sentence(page, f"in {{:.0f}} fewer than {LEAST_WITHIN} % of the errors lie within two sigmas", [narrow])
    pages.sentence(page, f"in {{:.0f}} a lie lasts longer than {MOST_LIE_S} s", [lies])
    pages.sentence(page, f"in {{:.0f}} more than {MOST_FALSE_PER_H} changes an hour are told that did not happen", [false])
    pages.sentence(page, "{:.0f} of {:.0f} changes of the device are missed", [missed, due])


# Colours of the command's pictures, light and dark; and the picture's size, pixels.
INK, MESH, PAPER, BLUE = ("#22262B", "#e4e7eb"), ("#DDE1E6", "#343a42"), ("#FFFFFF", "#181b20"), "#2F7FD6"
WIDTH, LEFT, ROW, ABOVE, BELOW = 830, 370, 22, 14, 44


def evaluation_picture(pages):
    """A dot for each situation at its median error, on a scale of equal ratios; a row for each group, with a bar at its median."""
    groups = {}
    for line in data(pages, EVALUATION):
        if line["error_median_deg"]:
            groups.setdefault(line["group"].removeprefix("Carried phones: "), []).append(max(float(line["error_median_deg"]), LEAST_DEG))
    most = max(max(errors) for errors in groups.values()) * 1.15
    x = lambda deg: LEFT + (WIDTH - LEFT - 20) * math.log(deg / LEAST_DEG * 1.15) / math.log(most / LEAST_DEG * 1.15)
    height = ABOVE + BELOW + ROW * len(groups)
    bottom = height - BELOW
    rules = "".join(f'[{what}="{light}"]{{{what}:{dark}}}' for light, dark in (INK, MESH, PAPER) for what in ("fill", "stroke"))
    out = [f'<svg width="{WIDTH}" height="{height}" viewBox="0 0 {WIDTH} {height}" xmlns="http://www.w3.org/2000/svg" font-family="sans-serif" font-size="12">',
           f"<style>@media (prefers-color-scheme: dark){{{rules}}}</style>", f'<rect width="{WIDTH}" height="{height}" fill="{PAPER[0]}"/>']
    for deg in (tick for tick in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 180) if LEAST_DEG <= tick <= most):
        out += [f'<path d="M{x(deg):.1f} {ABOVE}V{bottom}" stroke="{MESH[0]}"/>',
                f'<text x="{x(deg):.1f}" y="{bottom + 16}" text-anchor="middle" fill="{INK[0]}">{deg:g}</text>']
    for k, (group, errors) in enumerate(groups.items()):
        y = ABOVE + ROW * (k + 0.5)
        out.append(f'<text x="{LEFT - 8}" y="{y + 4:g}" text-anchor="end" fill="{INK[0]}">{html.escape(group)}</text>')
        out += [f'<circle cx="{x(error):.1f}" cy="{y:g}" r="4" fill="{BLUE}" fill-opacity="0.6"/>' for error in errors]
        out.append(f'<path d="M{x(median(errors)):.1f} {y - 8:g}v16" stroke="{INK[0]}" stroke-width="2"/>')
    out += [f'<text x="{(LEFT + WIDTH - 20) / 2:g}" y="{bottom + 36}" text-anchor="middle" fill="{INK[0]}">error of the heading, median run, deg</text>', "</svg>", ""]
    pages.replace("docs/pictures/evaluation.svg", "\n".join(out))


# Errors below this are drawn there, degrees.
LEAST_DEG = 0.1


def evaluation(pages):
    """Judges all situations anew; EVALUATION tells what changed most since the file before."""
    before = {(line["group"], line["situation"]): line for line in data(pages, EVALUATION)}
    pages.replace(EVALUATION, run("evaluate", "--judge", "--csv"))
    changed, only = [], []
    for line in data(pages, EVALUATION):
        old = before.get((line["group"], line["situation"]))
        if old is None:
            only.append(line["situation"])
        elif old["error_median_deg"] and line["error_median_deg"]:
            was, now = float(old["error_median_deg"]), float(line["error_median_deg"])
            # of errors of some degrees the ratio says more than the difference; those below half a degree do not matter
            changed.append((max(was, 0.5) / max(now, 0.5), [line["situation"], f"{was:.1f}", f"{now:.1f}"]))
    changed.sort(key=lambda one: -max(one[0], 1 / one[0]))
    pages.table("docs/EVALUATION.md", "## Since the page before", [row for ratio, row in changed[:6] if ratio != 1] or [["nothing", "", ""]])


# COMPARISON's groups of phones, and how its tables call the methods.
QUIET, RUNNING, BOARDS = "quiet room", "running", "past boards with magnets"
PUT_ON = ", a magnet put on"
FUSED, SYSTEM, VQF, OURS = "the phone's own heading", "the system's field", "VQF on the system's field", "magcomp: heading"


# In the data alone: of no use on a phone, whose own field is larger than the Earth's, or the same as a calibration of that day.
LEFT_OUT = {"the raw field", "x-io Fusion on the raw field", "VQF on the raw field", "a sphere, window of 2000", "an ellipsoid, window of 2000", "the paper's method, cold",
            "the paper's method, with its first step"}


def scores(pages, group, method, key="rms_deg"):
    return [float(line[key]) for line in data(pages, COMPARISON) if (line["group"], line["method"]) == (group, method) and line[key]]


def two(values):
    """Median and worst."""
    return f"{median(values):.1f} ({max(values):.1f})" if values else "-"


def comparison_page(pages):
    page, lines = "docs/COMPARISON.md", data(pages, COMPARISON)
    methods = list(dict.fromkeys(line["method"] for line in lines))
    phones = [QUIET, QUIET + PUT_ON, RUNNING, RUNNING + PUT_ON, BOARDS]
    def rows(groups, key, methods=methods):
        table = [[method, *(two(scores(pages, group, method, key)) for group in groups)] for method in methods]
        table = [row for row in table if set(row[1:]) != {"-"}]
        first = lambda row: min(float(cell.split()[0]) for cell in row[1:] if cell != "-")
        return sorted(table, key=lambda row: float(row[1].split()[0]) if row[1] != "-" else first(row))
    pages.table(page, "### Up to one constant", rows(phones, "rms_deg", [method for method in methods if method not in LEFT_OUT]))
    pages.table(page, "### Against north", rows(phones, "north_rms_deg", [FUSED, SYSTEM, VQF, "VQF on a fit with the gyroscope's turns", OURS]))
    sure = []
    for group in phones:
        own = [line for line in lines if (line["group"], line["method"]) == (group, OURS)]
        if own:
            mean = sum(float(line["answered_percent"]) for line in own) / len(own)
            within = [float(line["within_2_sigma_percent"]) for line in own if line["within_2_sigma_percent"]]
            changes = sum(int(line["device_changes"]) for line in own)
            true = len(own) if group.endswith(PUT_ON) else 0
            sure.append([group, str(len(own)), f"{mean:.0f}", f"{median(within):.0f} ({min(within):.0f})", f"{changes} of {true}"])
    pages.table(page, "### How sure", sure)
    pages.table(page, "### Other magnets", magnets_table(data(pages, MAGNETS)))
    worst = lambda magnet: max(float(line["error_deg"]) for line in data(pages, MAGNETS) if line["magnet"] == magnet and line["group"] == QUIET and line["error_deg"])
    pages.sentence(page, "with 300 uT put on one recording is {:.1f} degrees off afterwards, with 150 uT slid on over 10 s one is {:.1f}",
                   map(worst, ("300 uT at once", "150 uT over 10 s")))
    sensor = ["nothing disturbs", "past a magnet that stands still", "a magnet on the sensor"]
    pages.table(page, "## A sensor with magnets", rows(sensor, "rms_deg", [method for method in methods if "window of" not in method]))
    north = [median(scores(pages, sensor[0], method, "north_rms_deg")) for method in ("VQF on the raw field", "x-io Fusion on the raw field", OURS)]
    pages.sentence(page, "Against north VQF on its raw field has {:.1f} degrees, x-io Fusion {:.1f}, magcomp {:.1f}.", north)
    answered = scores(pages, sensor[2], OURS, "answered_percent")
    pages.sentence(page, "magcomp answers {:.0f} % of all rows, VQF and x-io Fusion all.", [sum(answered) / len(answered)])
    found = [line for line in lines if line["group"] == sensor[2] and line["method"] == OURS]
    steps, off = ([float(line[key]) for line in found] for key in ("step_ut", "step_off_ut"))
    pages.sentence(page, "by {:.1f} to {:.1f} uT, which magcomp finds to {:.1f} uT at the worst", [min(steps), max(steps), max(off)])


def magnets_table(lines):
    """A row for each magnet that was put on phones in a quiet room."""
    rows = []
    for magnet in dict.fromkeys(line["magnet"] for line in lines):
        own = [line for line in lines if line["magnet"] == magnet and line["group"] == QUIET]
        told = [float(one) for line in own for one in line["told_s"].split(";") if one]
        missed, due, again = (sum(int(line[key]) for line in own) for key in ("missed", "due", "again"))
        errors = [[float(line[key]) for line in own if line[key]] for key in ("error_deg", "worst_deg")]
        rows.append([magnet, *map(two, errors), two(told), f"{missed} of {due}", str(again)])
    return rows


def magnets(pages, phones):
    """Magnets of many sizes, put on each recording by the command."""
    found = json.loads(run("evaluate", "--recordings", str(Path(phones).resolve()), "--magnets", "--json"))["runs"]
    cell = lambda value, digits=1: "" if value is None else f"{value:.{digits}f}"
    out = ["group,recording,magnet,error_deg,worst_deg,answered_percent,within_2_sigma_percent,told_s,missed,due,again"]
    for one in found:
        percent = [one["answered"], one["within"] and one["within"][1]]
        shown = [cell(one["error"]["heading_deg"]), cell(one["worst_deg"]), *(cell(share and 100 * share, 0) for share in percent)]
        told = ";".join(cell(told) for told in one["told_s"] if told is not None)
        counts = [str(one[key]) for key in ("missed", "due", "again")]
        out.append(",".join([f'"{one["group"]}"', one["recording"], f'"{one["magnet"]}"', *shown, told, *counts]))
    pages.replace(MAGNETS, "\n".join([*out, ""]))


def readme(pages):
    """README's table is median and worst of docs/data/comparison.csv."""
    for name, group in (("in a quiet room, {}", QUIET), ("running, {}", RUNNING), ("past boards with magnets inside, {}", BOARDS),
                        ("quiet, from a magnet on the phone on, {}", QUIET + PUT_ON)):
        found = [scores(pages, group, method) for method in (FUSED, VQF, OURS)]
        answered = scores(pages, group, OURS, "answered_percent")
        begin = name.format("{:.0f}")
        own = "" if not found[0] else "{:.1f}, worst {:.1f}"
        template = f"| {begin} | {own or '-'} | {{:.1f}}, worst {{:.1f}} | **{{:.1f}}**, worst {{:.1f}} | {{:.0f}} % |"
        values = [len(found[2])]
        for one in found if found[0] else found[1:]:
            values += [median(one), max(one)]
        pages.sentence("README.md", template, [*values, sum(answered) / len(answered)])
    north = [median(scores(pages, group, OURS, "north_rms_deg")) for group in (QUIET, RUNNING, BOARDS)]
    pages.sentence("README.md", "With it left in, magcomp has {:.1f}, {:.1f} and {:.1f}.", north)
    alone = scores(pages, BOARDS, "magcomp, magnetometer alone: corrected sample")
    pages.sentence("docs/LIMITS.md", "the heading is of no use: {:.1f} degrees off, {:.1f} at worst", [median(alone), max(alone)])
    [car] = [line for line in data(pages, EVALUATION) if line["situation"] == "in a hand, a car of 30 uT closes at 30 s"]
    pages.sentence("README.md", "in a car without satellite courses: {} degrees off in a hand", [car["error_median_deg"]])


# How pages say what share of magcomp's work VQF takes.
SHARES = {2: "half", 3: "a third", 4: "a quarter", 5: "a fifth", 6: "a sixth", 7: "a seventh", 8: "an eighth"}


def cost(pages):
    """Instructions a sample and times VQF are those of COST at 100 Hz."""
    [row] = [cells(row) for row in pages.text("docs/dev/COST.md").splitlines() if row.startswith("| 100 |")]
    instructions, share = f"{int(row[1]):,}".replace(",", " "), SHARES.get(round(float(row[2])), "?")
    for name, pattern, says in (
        ("README.md", r"(?<=A sample costs )[\d ]+(?= instructions)", instructions),
        ("docs/GUIDE.md", r"\d[\d ]*(?= instructions a sample at 100 Hz)", instructions),
        ("README.md", r"(?<=nearer north, for ).*(?= of the work)", share),
        ("docs/COMPARISON.md", r"(?<=takes )an? \w+(?= of the work)", share),
    ):
        found = re.search(pattern, pages.text(name))
        if found is None:
            pages.wrong.append(f"{name}: nothing reads {pattern!r}")
        elif found.group().strip() != says:
            text, (begin, end) = pages.text(name), found.span()
            pages.expect(name, text[begin - 20 : end + 20], text[begin - 20 : begin] + says + text[end : end + 20], "COST")


def comparison(pages, phones=None, put_on=None):
    """Compares all methods on the recordings that are here, and on phones where they were downloaded."""
    folders = [Path("tests/recordings")] + ([Path(phones), Path(put_on)] if phones else [])
    kept = [] if phones else [line for line in pages.text(COMPARISON).splitlines()[1:] if ",broad_" not in line]
    lines, head = [], ""
    for folder in folders:
        entries = [(FUSED, folder / "fused")] + [(name, folder.parent / f"{folder.name}-{answers}") for name, answers in RIVALS]
        entries = [part for name, answers in entries if answers.is_dir() for part in ("--entry", f"{name}={answers.resolve()}")]
        with tempfile.TemporaryDirectory() as report:
            head, *own = run("compare", "--recordings", str(folder.resolve()), "--csv", *entries, "--report", report).splitlines()
            picture = Path(report, f"over_time_{SHOWN}.svg")
            if picture.exists():
                pages.replace("docs/pictures/magnet_on_a_phone.svg", picture.read_text())
        lines += own
    pages.replace(COMPARISON, "\n".join([head, *lines, *kept, ""]))
    if phones:
        magnets(pages, phones)


# Programs that are none of ours: their names in tables, and those of benchmarks/rivals.py. And the recording of README's picture.
RIVALS = [("react-native-nitro-compass", "react-native"), ("MAGYC over the whole recording, then VQF", "magyc"),
          ("MAGYC online, then VQF", "magyc-online")]
SHOWN = "Jakob_iPhone5_NoDist_Texting_d3_uncal"


def run(*arguments):
    """What the command prints."""
    command = os.environ.get("MAGCOMP") or os.environ.get("CARGO_TARGET_DIR", "target") + "/release/magcomp"
    print("figures: magcomp", *arguments, flush=True)
    return subprocess.run([str(Path(ROOT, command)), *arguments], cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout


def magcomp(*arguments):
    return json.loads(run(*arguments, "--json"))


def half(result):
    return next(one for one in result["normalisations"] if one["normalisation"] == "HalfRange")


def steady(one):
    return [parameter["steady_percent"]["mean"] for parameter in one["parameters"]]


def slowest(one):
    slow = [parameter for parameter in one["parameters"] if parameter["transient_samples"] is not None]
    slow = max(slow, key=lambda parameter: parameter["transient_samples"])
    return slow["transient_samples"], slow["transient_sd"]


def answer(result, name):
    return next(answer for answer in result["answers"] if answer["name"] == name)


def headline(pages):
    with tempfile.TemporaryDirectory() as folder:
        found = magcomp("demo", "--runs", "1", "--report", folder)["headline"]
        pages.replace("docs/pictures/heading_error.svg", Path(folder, "heading_error.svg").read_text())
    three = [found["raw_deg"], found["vqf_deg"], found["magcomp_deg"]]
    pages.sentence("README.md", "It prints {:.0f}, {:.1f} and {:.1f} degrees", three)


def steps(pages):
    """COMPARISON's seconds beside the paper's method with magcomp's checks."""
    for motion in ("tumble", "walk"):
        arguments = ["paper", "phone", "--motion", motion, "--runs", "20"]
        found = magcomp(*arguments)
        both = [answer(found, name)["below_2_deg"] for name in ("windowed, c", "aided, c")]
        values = [one[key] for one in both for key in ("median", "worst")]
        pages.sentence("docs/COMPARISON.md", f"| `magcomp {' '.join(arguments)}` | {{:.1f}} | {{:.1f}} | {{:.1f}} | {{:.1f}} |", values)


def paper(pages):
    page = "docs/dev/PAPER.md"
    usual = half(magcomp("paper", "step", "--normalisation", "half-range"))
    algebraic = half(magcomp("paper", "step", "--normalisation", "half-range", "--residual", "algebraic"))
    pages.sentence(page, "`magcomp paper step --normalisation half-range`: sigma_T {:.3f}, N {:.0f}", [usual["sigma_t"]["mean"], usual["window"]["mean"]])
    pages.sentence(page, "{:.0f} +- {:.0f} for the slowest parameter", slowest(usual))
    pages.sentence(page, "whose window is not cut: {:.0f} +- {:.0f}", slowest(algebraic))
    pages.sentence(page, "hardly matters: {:.2f} and {:.2f} %", [max(steady(usual)), max(steady(algebraic))])
    kept, after = usual["kept"], usual["after"]
    pages.sentence(page, "| {:.1f} and {:.1f} deg, mean of the peaks |", [kept["azimuth_deg"]["mean"], kept["elevation_deg"]["mean"]])
    angles = [after[angle][which] for which in ("mean", "max") for angle in ("azimuth_deg", "elevation_deg")]
    pages.sentence(page, "after the transient {:.1f} and {:.1f} deg mean, {:.1f} and {:.1f} deg at most", angles)
    longer = half(magcomp("paper", "step", "--normalisation", "half-range", "--n-max", "4000"))
    pages.sentence(page, "--n-max 4000`: N {:.0f}, longest transient {:.0f} samples, worst steady error {:.1f} % instead of {:.1f} %",
                   [longer["window"]["mean"], slowest(longer)[0], max(steady(longer)), max(steady(usual))])
    planar = half(magcomp("paper", "step", "--motion", "planar", "--normalisation", "half-range", "--runs", "20"))
    pages.sentence(page, "--runs 20`: sigma_T {:.2f} +- {:.2f}; errors of {:.0f} to {:.0f} % after the step",
                   [planar["sigma_t"]["mean"], planar["sigma_t"]["sd"], min(steady(planar)), max(steady(planar))])
    still = half(magcomp("paper", "step", "--motion", "still", "--normalisation", "half-range", "--runs", "10"))
    pages.sentence(page, "--runs 10`: {:.2f} +- {:.2f}, nothing followed", [still["sigma_t"]["mean"], still["sigma_t"]["sd"]])
    stroll = half(magcomp("paper", "step", "--motion", "stroll", "--normalisation", "half-range", "--runs", "3"))
    pages.sentence(page, "strolling leaves {:.0f} to {:.0f} %", [min(steady(stroll)), max(steady(stroll))])
    bound = magcomp("paper", "bound", "--runs", "100", "--snr", "35,40")["rows"]
    ratios = [ratio for row in bound for ratio in row["corrected"]]
    diagonal = lambda snr: [row["algebraic"][0] for row in bound if row["snr_db"] == snr]
    pages.sentence(page, "corrected: {:.2f} to {:.2f} of the bound in all groups. (10) as written, in the diagonal of M: {:.2f} to {:.2f} at 40 dB and {:.2f} to "
                   "{:.2f} at 35 dB", [f(values) for values in (ratios, diagonal(40.0), diagonal(35.0)) for f in (min, max)])


def aided(pages):
    """METHOD-AIDED's table of a bad gyroscope."""
    poor = "--gyro-bias 5 --gyro-scale 1 --gyro-late 10 --rate 25 --seed 2001".split()
    for motion, name in (("tumble", "tumbling"), ("walk", "walking")):
        for snr in (40, 30):
            noise = ["--snr", "30"] if snr == 30 else []
            found = magcomp("paper", "phone", "--runs", "20", "--motion", motion, *poor, *noise)
            seconds = answer(found, "aided, c")["below_2_deg"]
            within = next(one for one in found["methods"] if one["method"] == "Aided")["line"]["within"]
            pages.sentence("docs/dev/METHOD-AIDED.md", f"| {name}, {snr} dB | {{:.1f}} s | {{:.1f}} s | {{:.0f}} %, {{:.0f}} % |",
                           [seconds["median"], seconds["worst"], 100 * within[0], 100 * within[1]])


def main():
    arguments = sys.argv[1:]
    writes = "--write" in arguments
    what, *folders = [argument for argument in arguments if argument != "--write"] or ["pages"]
    runs = {"pages": [], "evaluation": [evaluation], "comparison": [lambda pages: comparison(pages, *folders)],
            "commands": [headline, steps, paper, aided]}
    if what not in runs or len(folders) not in ((0, 2) if what == "comparison" else (0,)):
        sys.exit(__doc__)
    pages = Pages()
    for part in [*runs[what], limits, evaluation_page, evaluation_picture, comparison_page, readme, cost]:
        part(pages)
    for wrong in pages.wrong:
        print(f"figures: {wrong}", file=sys.stderr)
    if writes:
        for name in pages.changed:
            (ROOT / name).write_text(pages.text(name))
    sys.exit(1 if pages.wrong else 0)


main()
