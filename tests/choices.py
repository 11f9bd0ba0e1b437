#!/usr/bin/env python3
"""The chosen numbers of the core, counted by part, and the jobs that they do.

A choice is an entry of `choices! { ... }`, whatever its value is made of: each can be set by itself. So is a constant whose doc comment begins with
`Choice:`, and one of no kind, of type f64, whose value is made of names: another's number in its own coat. What a constant is stands in
front of its doc comment: `Physics:`, `Data sheet:`, `Mathematics:` (what follows from equations, rounding or other constants), `Format:` (of texts
and interfaces), `Limit:` (beyond it input is refused) or `Choice:`. A bare number in the code is a choice too, but for those that PLAIN lists: what
halves, doubles and squares, conversions of units, sizes of matrices.

A job is a function that reads a choice, tests apart: `tuning.NAME`, `Tuning::USED.NAME`, `let Tuning { NAME, .. }`, or the constant's NAME. Jobs are
told beside choices: a number with jobs that have nothing to do with one another should be two.

Fails when a constant has no kind, when an entry has no source, when a choice names a file that is not there, when nothing reads an entry, and when there
are more choices than MOST. `--list` prints every choice with its jobs and its place.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CORE = ROOT / "rust/magcomp/src"

# How many there are today. It only falls from here, but for a new quantity that is measured.
MOST = 160

KINDS = ("Choice", "Physics", "Data sheet", "Mathematics", "Format", "Limit")

# Bare numbers that are no choices, and powers of ten.
UNITS = {60, 90, 180, 270, 360, 3600}  # minutes, degrees, hours
SIZES = {6, 9, 12}  # of matrices, and what integrals of them are divided by
PLAIN = {0, 0.5, 1, 2, 3} | UNITS | SIZES | {float(f"1e{k}") for k in range(-18, 19)}
# Equations, and settings with their defaults, whose numbers say what they are.
NO_CHOICES = ("math", "ellipsoid", "config")

ENTRY = re.compile(r'^\s*(\w+):\s*([^,;]+),\s*"([^"]*)",\s*"([^"]*)";', re.MULTILINE)
CONSTANT = re.compile(
    r"(?P<docs>(?:^[ \t]*///[^\n]*\n)*)(?:^[ \t]*#\[[^\n]*\n)*^[ \t]*(?:pub(?:\([^)]*\))? )?const (?P<name>[A-Z]\w*)\s*:"
    r"(?P<type>(?:[^=;\[]|\[[^\]]*\])+)=",
    re.MULTILINE,
)
BARE = re.compile(r"(?<![\w.])(\d[\d_]*\.(?!\.)\d*(?:e-?\d+)?|\d+e-?\d+)(?:_f64)?(?![\w.]*\s*=>)")
PLACE = re.compile(r"\b(?:tests|docs|rust)/[\w/.-]*\w")
NO_CODE = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\])*\"|'(?:\\.|[^'\\])'", re.DOTALL)
FUNCTION = re.compile(r"\bfn\s+(\w+)")
USE = re.compile(r"\buse\s+([^;]+);")


def closing(text, at):
    """Where the brace that was opened just before `at` is closed."""
    depth = 1
    while depth:
        depth += {"{": 1, "}": -1}.get(text[at], 0)
        at += 1
    return at - 1


def macros(text):
    """Where each `choices! { ... }` begins and ends, inside its braces."""
    for found in re.finditer(r"\bchoices! \{", text):
        yield found.end(), closing(text, found.end())


def code_of(text):
    """The text without comments and strings, of the same length."""
    return NO_CODE.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)


def constants(text):
    """Each constant as its match, which ends where its value begins, and where that ends."""
    code = code_of(text)
    for found in CONSTANT.finditer(text):
        at, depth = found.end(), 0
        while depth or code[at] != ";":
            depth += {"{": 1, "[": 1, "(": 1, "}": -1, "]": -1, ")": -1}.get(code[at], 0)
            at += 1
        yield found, at


def bare(text):
    """Bare numbers of the code: without comments, strings, attributes, constants and the contents of `choices!`."""
    cuts = list(macros(text)) + [(found.start(), end) for found, end in constants(text)]
    for begin, end in sorted(cuts, reverse=True):
        text = text[:begin] + text[end:]
    for line in text.splitlines():
        if re.match(r"(?:pub(?:\([^)]*\))? )?const ", line):
            continue
        line = re.sub(r'"[^"]*"|//.*|#\[.*', "", line)
        for number in BARE.findall(line):
            if float(number.replace("_", "")) not in PLAIN:
                yield number, line.strip()


NAMES = re.compile(r"\b[A-Z][A-Z_]{2,}\b|\b\w+\.\w+\b")


def names_of(value):
    """The names that a value is made of."""
    return NAMES.findall(re.sub(r"\d[\d_.]*", "", value))


def is_chosen(value):
    """Whether a value has a number of its own: not names alone, nor with numbers that PLAIN lists."""
    numbers = re.findall(r"(?<![\w.])-?\d[\d_]*(?:\.\d*)?(?:e-?\d+)?", re.sub(r'"[^"]*"', "", value))
    return any(not names_of(value) or abs(float(number.replace("_", ""))) not in PLAIN for number in numbers)


def imports(tree, path=()):
    """(path, local name) of everything in a `use` tree."""
    tree = tree.strip()
    head, braces, rest = tree.partition("{")
    path += tuple(name for name in head.split("::")[:-1] if name) if braces or "::" in head else ()
    if not braces:
        name, _, alias = head.split("::")[-1].partition(" as ")
        yield (*path, name.strip()), (alias or name).strip()
        return
    depth, begin = 0, 0
    inside = rest[: closing(rest, 0)] + ","
    for at, letter in enumerate(inside):
        depth += {"{": 1, "}": -1}.get(letter, 0)
        if letter == "," and not depth:
            if inside[begin:at].strip():
                yield from imports(inside[begin:at], path)
            begin = at + 1


class File:
    """A file of the core: its code without comments and strings, of the same length, and what stands where in it."""

    def __init__(self, core, path):
        self.path = path
        # tests in a file of the code stand last
        self.text = re.split(r"#\[cfg\(test\)\]\s*mod \w+ \{", path.read_text())[0]
        self.code = code_of(self.text)
        names = path.relative_to(core).with_suffix("").parts
        # a folder, or a file that stands alone, by its path in the core
        self.part = "/".join(names[:2] if names[0] == "estimator" else names[:1])
        # the module's own name, and the folder whose files may read its choices
        self.module = names[-2] if names[-1] == "mod" and len(names) > 1 else names[-1]
        self.room = path.parent if len(names) > 1 else path
        self.functions = list(self._functions())
        self.constants = {found["name"]: (found, end) for found, end in constants(self.text)}
        inside = list(macros(self.text))
        self.entries = {found[1]: found for begin, end in inside for found in ENTRY.finditer(self.text, begin, end)}
        self.imports = [one for found in USE.finditer(self.code) for one in imports(found[1])]
        self.derived = [(found.end(), end, name) for name, (found, end) in self.constants.items()]
        self.derived += [(*found.span(2), name) for name, found in self.entries.items()]
        self.uses = [found.span() for found in USE.finditer(self.code)]

    def _functions(self):
        for found in FUNCTION.finditer(self.code):
            at, depth = found.end(), 0
            while at < len(self.code) and (depth or self.code[at] not in "{;"):
                depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(self.code[at], 0)
                at += 1
            if self.code[at : at + 1] == "{":
                yield found.start(), closing(self.code, at + 1), found[1]

    def reader(self, at):
        """What stands about a place: a choice that is derived there, the innermost function, or nothing that counts."""
        for begin, end, name in self.derived:
            if begin <= at < end:
                return "derived", self, name
        about = [one for one in self.functions if one[0] <= at < one[1]]
        is_import = any(begin <= at < end for begin, end in self.uses)
        return ("job", self, max(about)) if about and not is_import else None

    def places(self, name, pattern):
        """Readers at every place of the name that fits the pattern."""
        if name not in self.code:
            return []
        found = (self.reader(found.start(1)) for found in re.finditer(pattern, self.code))
        return [reader for reader in found if reader]


class Core:
    """All files, and who reads what."""

    def __init__(self, core):
        paths = (path for path in sorted(core.rglob("*.rs")) if "tests" not in path.relative_to(core).with_suffix("").parts)
        self.files = [File(core, path) for path in paths if path != core / "tuning.rs"]
        self.known = {}

    def reads(self, home, name):
        """Readers of the choice that `home` makes, each looked for once."""
        if (home.path, name) not in self.known:
            self.known[home.path, name] = list(self.found(home, name))
        return self.known[home.path, name]

    def found(self, home, name):
        if name in home.entries:
            own = rf"\b(?:self|\w*tuning|Tuning::USED)\.({name})\b(?!\s*\()|\bTuning \{{[^}}]*?\b({name})\b[^}}]*\}}\s*="
            own = rf"(?=({own}))"
            near = [file for file in self.files if file.path == home.room or home.room in file.path.parents]
            for file in near:
                yield from file.places(name, own if file is home else own.replace("self|", r"self\.tuning|"))
            qualified = rf"\b{home.part.split('/')[-1]}::Tuning::USED\.({name})\b"
            for file in self.files:
                if file not in near:
                    yield from file.places(name, qualified)
            return
        for file in self.files:
            # as this file calls it: by its own name at home, by that of an import elsewhere
            if file is home:
                local = {name}
            else:
                local = {alias for path, alias in file.imports if path[-1] == name and self.is_of(home, name, file, path)}
            for called in local:
                yield from file.places(called, rf"(?<![\w:.])({called})\b(?!\s*:[^:])")
            if file is not home:
                yield from file.places(name, rf"\b{home.module}::({name})\b")

    def is_of(self, home, name, file, path):
        """Whether this import is the constant of `home`."""
        above = path[-2] if len(path) > 1 else ""
        if above in ("super", "self", "crate"):
            folder = file.path.parent
            return home.path in (folder / "mod.rs", folder.with_suffix(".rs"), *([file.path] if above == "self" else []))
        return above == home.module or not any(other is not home and name in other.constants for other in self.files)

    def jobs(self, home, name):
        """The functions that read a choice, and the choices that are made of it."""
        return {(file.path, what) for _, file, what in self.reads(home, name) if (file, what) != (home, name)}


def count(core, root):
    """Every choice of the core as (part, name, value, file, jobs), and what is wrong."""
    core, choices, faults = Core(core), [], []
    for file in core.files:
        short = file.path.relative_to(root)
        if file.part not in NO_CHOICES and file.path.stem != "config":
            choices += [(file.part, line[:60], number, short, 1) for number, line in bare(file.text)]
        for name, found in file.entries.items():
            value, source = found[2].strip(), found[4]
            jobs = len(core.jobs(file, name))
            choices.append((file.part, name, value, short, max(jobs, 1)))
            if not jobs:
                faults.append(f"{short}: nothing reads {name}; delete it")
            if not source:
                faults.append(f"{short}: {name} has no source")
            faults += [f"{short}: {name} names {place}, which is not there" for place in PLACE.findall(source)
                       if not (root / place).exists()]
        for name, (found, end) in file.constants.items():
            value = file.text[found.end() : end]
            docs = " ".join(line.strip().removeprefix("///").strip() for line in found["docs"].splitlines())
            kind = docs.split(":")[0] if docs.startswith(tuple(f"{kind}:" for kind in KINDS)) else None
            is_coat = kind is None and found["type"].strip() == "f64" and names_of(value)
            if kind == "Choice" or is_coat:
                faults += [f"{short}: {name} names {place}, which is not there" for place in PLACE.findall(docs)
                           if not (root / place).exists()]
                choices.append((file.part, name, " ".join(value.split()), short, max(len(core.jobs(file, name)), 1)))
            elif kind is None and is_chosen(value) and "str" not in found["type"]:
                faults.append(f"{short}: {name} has no kind; begin its comment with one of {', '.join(KINDS)}")
    return choices, faults


def main():
    choices, faults = count(CORE, ROOT)
    parts = {}
    for part, name, value, place, jobs in choices:
        numbers, own = parts.get(part, (0, 0))
        parts[part] = (numbers + 1, own + jobs)
        if "--list" in sys.argv:
            print(f"{part:20} {name:60} {value:24} {jobs:3} {place}")
    for part, (numbers, jobs) in sorted(parts.items()):
        print(f"{numbers:4} choices, {jobs:4} jobs: {part}")
    numbers, jobs = len(choices), sum(jobs for *_, jobs in choices)
    print(f"{numbers:4} choices in all, {MOST} at most; {jobs} jobs")
    if numbers > MOST:
        faults.append(f"{numbers} choices are more than {MOST}: derive or learn what you can, and say in MOST if not")
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
