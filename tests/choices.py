#!/usr/bin/env python3
"""The chosen numbers of the core, counted by part.

A choice is an entry of `choices! { ... }`, or a constant with a number in it whose doc comment begins with `Choice:`. What a constant is
stands in front of its doc comment: `Physics:`, `Data sheet:`, `Mathematics:` (what follows from equations, rounding or other constants),
`Format:` (of texts and interfaces), `Limit:` (beyond it input is refused) or `Choice:`. One whose value is
made of names, which may be halved, doubled or squared, is derived. A bare number in the code is a choice too, but for those that PLAIN lists.

Fails when a constant has no kind, when an entry has no source or names a file that is not there, and when there are more choices than MOST.
`--list` prints every choice with its place.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CORE = ROOT / "rust/magcomp/src"

# How many there are today; the goal is 60. It only falls, but for a new quantity that is measured: headings from outside brought eight.
MOST = 88

KINDS = ("Choice", "Physics", "Data sheet", "Mathematics", "Format", "Limit")

# Bare numbers that are no choices: halves, squares, three axes, six elements, units of time and angle, and what divides by next to nothing.
PLAIN = {0, 0.5, 1, 1.5, 2, 3, 6, 9, 12, 90, 180, 360, 3600, 1e-6, 1e-9, 1e9}
# Equations, and settings with their defaults, whose numbers say what they are.
NO_CHOICES = ("math", "ellipsoid", "config")

ENTRY = re.compile(r'^\s*(\w+):\s*([^,;]+),\s*"([^"]*)",\s*"([^"]*)";', re.MULTILINE)
CONSTANT = re.compile(
    r"(?P<docs>(?:^[ \t]*///[^\n]*\n)*)(?:^[ \t]*#\[[^\n]*\n)*^[ \t]*(?:pub(?:\([^)]*\))? )?const (?P<name>[A-Z]\w*)\s*:"
    r"(?P<type>(?:[^=;\[]|\[[^\]]*\])+)=(?P<value>[^;]*(?:\[[^\]]*\][^;]*)*);",
    re.MULTILINE,
)
BARE = re.compile(r"(?<![\w.])(\d[\d_]*\.(?!\.)\d*(?:e-?\d+)?|\d+e-?\d+)(?:_f64)?(?![\w.]*\s*=>)")
PLACE = re.compile(r"\b(?:tests|docs|rust)/[\w/.-]*\w")


def macros(text):
    """Where each `choices! { ... }` begins and ends, inside its braces."""
    for found in re.finditer(r"\bchoices! \{", text):
        end, depth = found.end(), 1
        while depth:
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
        yield found.end(), end - 1


def bare(text):
    """Bare numbers of the code: without comments, strings, attributes, constants and the contents of `choices!`."""
    for begin, end in reversed(list(macros(text))):
        text = text[:begin] + text[end:]
    text = CONSTANT.sub("", text)
    for line in text.splitlines():
        if re.match(r"(?:pub(?:\([^)]*\))? )?const ", line):
            continue
        line = re.sub(r'"[^"]*"|//.*|#\[.*', "", line)
        for number in BARE.findall(line):
            if float(number.replace("_", "")) not in PLAIN:
                yield number, line.strip()


def is_chosen(value):
    """Whether a value has a number of its own: not a name, nor one that is halved, doubled or squared."""
    names = re.findall(r"\b[A-Z][A-Z_]{2,}\b|\b\w+\.\w+\b", re.sub(r"\d[\d_.]*", "", value))
    numbers = re.findall(r"(?<![\w.])-?\d[\d_]*(?:\.\d*)?(?:e-?\d+)?", re.sub(r'"[^"]*"', "", value))
    return any(not names or abs(float(number.replace("_", ""))) not in PLAIN for number in numbers)


def part_of(file):
    """A folder, or a file that stands alone, by its path in the core."""
    path = file.relative_to(CORE).with_suffix("")
    names = path.parts[:2] if path.parts[0] == "estimator" else path.parts[:1]
    return "/".join(names)


def main():
    choices, faults = [], []
    for file in sorted(CORE.rglob("*.rs")):
        if "tests" in file.relative_to(CORE).with_suffix("").parts or file.name == "tuning.rs" and file.parent == CORE:
            continue
        # tests in a file of the code stand last
        text = re.split(r"#\[cfg\(test\)\]\s*mod \w+ \{", file.read_text())[0]
        part, short = part_of(file), file.relative_to(ROOT)
        if part not in NO_CHOICES and file.stem != "config":
            choices += [(part, line[:60], number, short) for number, line in bare(text)]
        for begin, end in macros(text):
            for name, value, _unit, source in ENTRY.findall(text[begin:end]):
                if is_chosen(value):
                    choices.append((part, name, value.strip(), short))
                if not source:
                    faults.append(f"{short}: {name} has no source")
                faults += [f"{short}: {name} names {place}, which is not there" for place in PLACE.findall(source)
                           if not (ROOT / place).exists()]
        for found in CONSTANT.finditer(text):
            if not is_chosen(found["value"]) or "str" in found["type"]:
                continue
            docs = " ".join(line.strip().removeprefix("///").strip() for line in found["docs"].splitlines())
            kind = docs.split(":")[0] if docs.startswith(tuple(f"{kind}:" for kind in KINDS)) else None
            if kind == "Choice":
                choices.append((part, found["name"], " ".join(found["value"].split()), short))
            elif kind is None:
                faults.append(f"{short}: {found['name']} has no kind; begin its comment with one of {', '.join(KINDS)}")
    counts = {}
    for part, name, value, place in choices:
        counts[part] = counts.get(part, 0) + 1
        if "--list" in sys.argv:
            print(f"{part:20} {name:28} {value:24} {place}")
    for part, count in sorted(counts.items()):
        print(f"{count:4} {part}")
    print(f"{len(choices):4} choices in all, {MOST} at most")
    if len(choices) > MOST:
        faults.append(f"{len(choices)} choices are more than {MOST}: derive or learn what you can, and say in MOST if not")
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
