#!/usr/bin/env python3
"""The chosen numbers of the core, counted by part.

A choice is an entry of `choices! { ... }`, or a constant with a number in it whose doc comment begins with `Choice:`. What a constant is
stands in front of its doc comment: `Physics:`, `Data sheet:`, `Mathematics:` (what follows from equations, rounding or other constants),
`Format:` (of texts and interfaces), `Limit:` (beyond it input is refused) or `Choice:`. One whose value has no number in it is derived.

Fails when a constant has no kind, when an entry has no source or names a file that is not there, and when there are more choices than MOST.
`--list` prints every choice with its place.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CORE = ROOT / "rust/magcomp/src"

# How many there are today; the goal is 60. It only falls, but for a new quantity that is measured: headings from outside brought eight.
MOST = 150

KINDS = ("Choice", "Physics", "Data sheet", "Mathematics", "Format", "Limit")

# In these parts a constant without a kind counts as a choice. Nothing may be added; strike a part once its constants have kinds.
UNSORTED = ()

ENTRY = re.compile(r'^\s*(\w+):\s*([^,;]+),\s*"([^"]*)",\s*"([^"]*)";', re.MULTILINE)
CONSTANT = re.compile(
    r"(?P<docs>(?:^[ \t]*///[^\n]*\n)*)(?:^[ \t]*#\[[^\n]*\n)*^[ \t]*(?:pub(?:\([^)]*\))? )?const (?P<name>[A-Z]\w*)\s*:"
    r"(?P<type>(?:[^=;\[]|\[[^\]]*\])+)=(?P<value>[^;]*(?:\[[^\]]*\][^;]*)*);",
    re.MULTILINE,
)
PLACE = re.compile(r"\b(?:tests|docs|rust)/[\w/.-]*\w")


def macros(text):
    """The contents of each `choices! { ... }`."""
    for found in re.finditer(r"\bchoices! \{", text):
        end, depth = found.end(), 1
        while depth:
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
        yield text[found.end() : end - 1]


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
        for body in macros(text):
            for name, value, _unit, source in ENTRY.findall(body):
                choices.append((part, name, value.strip(), short))
                if not source:
                    faults.append(f"{short}: {name} has no source")
                faults += [f"{short}: {name} names {place}, which is not there" for place in PLACE.findall(source)
                           if not (ROOT / place).exists()]
        for found in CONSTANT.finditer(text):
            value = re.sub(r'"[^"]*"|\b[a-zA-Z_]\w*', "", found["value"])
            # paths, names and types have no number left
            if not re.search(r"\d", value) or "str" in found["type"]:
                continue
            docs = " ".join(line.strip().removeprefix("///").strip() for line in found["docs"].splitlines())
            kind = docs.split(":")[0] if docs.startswith(tuple(f"{kind}:" for kind in KINDS)) else None
            if kind == "Choice" or kind is None and part in UNSORTED:
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
