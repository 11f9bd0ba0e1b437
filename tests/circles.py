#!/usr/bin/env python3
"""Circles of imports in rust/: modules that import one another, directly or through others.

At each module its own file and its children, each with all below it, are points; an arrow goes from the one that imports to the
one that is imported. A circle is a set of points that all lead to one another. So a child that takes something from its parent's file
while that file uses the child is a circle, and so are two folders that need each other, whichever of their files do.

An import is a `use` or a path in the code that begins with `crate`, `super`, `self` or a child. What a file offers under another name
(`pub use`) counts as that of the file which defines it. Code for tests alone does not count.

Some rooms may import only what stands in FLOORS: what is below them.

Fails when there is a circle that KNOWN does not list, or when one that it lists is no more: strike it then. `--all` prints who
imports what in each.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# Still to be opened. Nothing may be added.
KNOWN = """
"""

# {module: {child: what it may import of the others}}
FLOORS = {
    "rust/magcomp/src/lib.rs": {
        "math": "",
        "calibration": "",
        "priors": "",
        "strength": "",
        "room": "",
        "status": "",
        "config": "calibration range",
        "ellipsoid": "math calibration config priors status",
        "coverage": "math calibration ellipsoid room",
        "level": "math",
        "heading": "config level math",
        "attitude": "heading level math",
        "pointing": "attitude heading config level",
        "sensing": "math priors range room sample status strength tuning",
        "kept": "calibration priors range",
    },
    "rust/magcomp/src/estimator/mod.rs": {
        "answer": "",
        "paper": "answer",
        "aided": "answer",
        "adaptive": "answer",
        "figures": "answer paper",
    },
    "rust/magcomp/src/estimator/paper/mod.rs": {
        "uniformity": "",
        "constant": "",
        "config": "uniformity",
        "window": "",
        "windowed": "config uniformity window",
    },
    "rust/magcomp-replay/src/lib.rs": {
        "error": "",
        "statistics": "",
        "table": "",
        "progress": "",
        "atomic": "error",
        "beside": "",
        "plot": "error statistics",
        "report": "atomic error plot table",
        "play": "atomic error",
        "judge": "beside play statistics",
        "say": "judge statistics table",
        "draw": "error judge play plot report statistics",
    },
    "rust/magcomp-lab/src/lib.rs": {
        "random": "",
        "parameters": "",
        "parallel": "",
        "motion": "random",
        "simulate": "course inertial magnetometer motion parameters random surroundings",
        "score": "simulate",
    },
    "rust/magcomp/src/sensing/mod.rs": {
        "frame": "",
        "tilt": "",
        "turning": "",
        "pairing": "",
        "order": "pairing",
        "hang": "pairing turning",
        "stand_in": "pairing",
        "axes": "hang pairing tilt turning",
        "witnesses": "axes frame pairing turning",
    },
    "rust/magcomp/src/estimator/aided/mod.rs": {
        "tuning": "",
        "recent": "",
        "state": "",
        "propagate": "state",
        "turned": "state",
        "step": "propagate state",
        "white": "state tuning",
        "groups": "state tuning turned",
        "measure": "state step tuning",
        "batch": "groups measure state",
        "bursts": "tuning",
        "watch": "state step tuning",
        "earth": "state step tuning",
        "motion": "propagate step tuning",
        "adapt": "measure propagate tuning white",
        "running": "earth state tuning watch",
        "events": "measure running state step tuning watch",
        "first_fit": "batch groups state step tuning",
        "probation": "running state step tuning watch",
        "quarantine": "propagate state step tuning turned",
        "phase": "events first_fit quarantine running state tuning watch",
    },
    "rust/magcomp/src/estimator/adaptive/mod.rs": {
        "tuning": "",
        "parameters": "",
        "frame": "",
        "grouping": "",
        "rate": "parameters",
        "spread": "frame",
        "published": "parameters",
        "state": "frame parameters rate spread tuning",
        "filter": "frame parameters rate state tuning",
        "bank": "filter frame parameters state tuning",
        "decision": "bank filter parameters tuning",
    },
    "rust/magcomp/src/compensator.rs": {
        "tuning": "",
        "presence": "tuning",
        "adopted": "tuning",
    },
}


def bare(text):
    """Rust without comments and the contents of strings."""
    pattern = re.compile(
        r"""//[^\n]*|/\*.*?\*/|\bb?r(?P<hashes>\#*)".*?"(?P=hashes)|"(?:\\.|[^"\\])*"|'(?:\\[^\n]+?|[^'\\\n])'""", re.DOTALL
    )
    return pattern.sub(" ", text)


def without_tests(text):
    """(the text without its `#[cfg(test)]` items, the names of its test modules in files of their own)"""
    modules = set()
    while found := re.search(r"#\[cfg\((?:test|doctest)\)\]", text):
        end, depth = found.end(), 0
        while end < len(text):
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
            if depth == 0 and text[end - 1] in ";}":
                break
        item = text[found.end() : end]
        if name := re.search(r"\bmod\s+(\w+)\s*;", item):
            modules.add(name[1])
        text = text[: found.start()] + text[end:]
    return text, modules


def without_inline(text):
    """Its modules without files of their own are a part of it: `super` in them is itself."""
    while found := re.search(r"\bmod\s+\w+\s*\{", text):
        end, depth = found.end(), 1
        while depth and end < len(text):
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
        body = re.sub(r"(?<!::)\bsuper\b", "self", text[found.end() : end - 1])
        text = text[: found.start()] + body + text[end:]
    return text


def branches(tree):
    """The paths of a `use` tree, each with the name it gets."""
    tree = tree.strip()
    if "{" not in tree:
        path, _, alias = tree.partition(" as ")
        path = path.split("::")
        if path[-1] == "self":
            path.pop()
        yield [p.strip() for p in path if p.strip()], (alias or path[-1]).strip()
        return
    stem, rest = tree.split("{", 1)
    parts, depth = [""], 0
    for letter in rest[: rest.rindex("}")]:
        depth += {"{": 1, "}": -1}.get(letter, 0)
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    for part in filter(str.strip, parts):
        yield from branches(stem + part.strip())


class Module:
    """A file of a crate."""

    def __init__(self, file, parent=None, name="crate"):
        self.file, self.parent, self.name = file, parent, name
        text, tests = without_tests(bare(file.read_text()))
        text = without_inline(text)
        folder = file.parent if file.stem in ("mod", "lib", "main") else file.with_suffix("")
        self.children = {}
        for child in re.findall(r"\bmod\s+(\w+)\s*;", text):
            places = [folder / f"{child}.rs", folder / child / "mod.rs"]
            if child not in tests and (place := next((p for p in places if p.exists()), None)):
                self.children[child] = Module(place, self, child)
        self.paths, self.offers = [], {}
        for public, tree in re.findall(r"\b(pub\b(?:\([^)]*\))?\s+)?use\s+([^;]+);", text):
            for path, name in branches(tree):
                self.paths.append(path)
                if public:
                    self.offers[name] = path
        code = re.sub(r"\buse\s+[^;]+;", "", text)
        self.paths += [path.split("::") for path in re.findall(r"(?<![\w:])\w+(?:::\w+)+", code)]

    def all(self):
        yield self
        for child in self.children.values():
            yield from child.all()

    def above(self):
        """From the root to this one."""
        return [*(self.parent.above() if self.parent else []), self]

    def find(self, path, seen=()):
        """The module whose file defines what a path means here; None outside the crate."""
        at, rest = self, list(path)
        if not rest or (rest[0] not in ("crate", "self", "super") and rest[0] not in self.children):
            return None
        if rest[0] == "crate":
            at = self.above()[0]
            rest.pop(0)
        while rest and rest[0] in ("self", "super"):
            at = at.parent if rest.pop(0) == "super" else at
            if at is None:
                return None
        for step in rest:
            if step in at.children:
                at = at.children[step]
            elif step in at.offers and (at, step) not in seen:
                return at.find(at.offers[step], (*seen, (at, step))) or at
            else:
                break
        return at


def arrows(crate):
    """{module: {(point, point): {(file, file)}}}"""
    levels = {}
    for module in crate.all():
        for target in filter(None, (module.find(path) for path in module.paths)):
            ours, theirs = module.above(), target.above()
            if module is target:
                continue
            common = 0
            while common < min(len(ours), len(theirs)) and ours[common] is theirs[common]:
                common += 1
            point = [chain[common].name if common < len(chain) else "." for chain in (ours, theirs)]
            level = levels.setdefault(ours[common - 1], {})
            level.setdefault(tuple(point), set()).add((module.file, target.file))
    return levels


def circles(pairs):
    """The sets of points that lead to one another."""
    reach = {}
    for start in {point for pair in pairs for point in pair}:
        reached, waiting = set(), [start]
        while waiting:
            at = waiting.pop()
            news = {there for here, there in pairs if here == at} - reached
            reached |= news
            waiting += news
        reach[start] = reached
    found = {frozenset(q for q in reach if q in reach[p] and p in reach[q]) for p in reach if p in reach[p]}
    return sorted(found, key=sorted)


def main():
    short = lambda path: str(path.relative_to(ROOT))
    found, upwards = {}, []
    for root in sorted([*ROOT.glob("rust/*/src/lib.rs"), *ROOT.glob("rust/*/src/main.rs"), ROOT / "tests/support/lib.rs"]):
        for module, pairs in arrows(Module(root)).items():
            floors = FLOORS.get(short(module.file), {})
            for (here, there), files in sorted(pairs.items()):
                if there not in floors.get(here, there).split():
                    upwards += [f"{short(importer)} -> {short(imported)}" for importer, imported in sorted(files)]
            for circle in circles(pairs):
                between = {pair: files for pair, files in pairs.items() if set(pair) <= circle}
                found[f"{short(module.file)}: {' '.join(sorted(circle))}"] = between
    if "--all" in sys.argv:
        for circle, between in sorted(found.items()):
            print(circle)
            for here, there in sorted({files for pair in between.values() for files in pair}):
                print(f"    {short(here)} -> {short(there)}")
    known = set(filter(None, KNOWN.splitlines()))
    for circle in sorted(set(found) - known):
        print(f"circle of imports: {circle} (tests/circles.py --all says who imports what)", file=sys.stderr)
    for circle in sorted(known - set(found)):
        print(f"no circle any more, strike it from KNOWN in tests/circles.py: {circle}", file=sys.stderr)
    for arrow in upwards:
        print(f"import that FLOORS in tests/circles.py does not allow: {arrow}", file=sys.stderr)
    return 1 if set(found) != known or upwards else 0


if __name__ == "__main__":
    sys.exit(main())
