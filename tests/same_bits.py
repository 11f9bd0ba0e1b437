#!/usr/bin/env python3
"""Compares the readings of two machines, as tests/host/readings.rs writes them: how many runs have the same bits, how far the others are apart."""

import json
import sys


def numbers(value, name=""):
    """Every number with its name; of what is no number, that."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from numbers(inner, f"{name}.{key}" if name else key)
    elif isinstance(value, list):
        for inner in value:
            yield from numbers(inner, name)
    else:
        yield name, value


def difference(a, b):
    """Relative to the larger, or to 1 where both are smaller; nothing where only whole numbers or words differ."""
    return abs(a - b) / max(abs(a), abs(b), 1.0)


def main(ours, theirs):
    runs, first, worst, other, headings, total = {}, {}, {}, 0, [], 0
    with open(ours) as a, open(theirs) as b:
        for line_a, line_b in zip(a, b, strict=True):
            name, text_a = line_a.split("\t")
            same, text_b = line_b.split("\t")
            if name != same:
                sys.exit(f"{ours} has the run {name} where {theirs} has {same}")
            at = runs.setdefault(name, [0, 0])
            at[0] += 1
            total += 1
            if text_a == text_b:
                continue
            at[1] += 1
            first.setdefault(name, at[0])
            pairs = zip(list(numbers(json.loads(text_a))), list(numbers(json.loads(text_b))), strict=False)
            for (field, x), (field_b, y) in pairs:
                if field != field_b or type(x) is not type(y) or not isinstance(x, float):
                    other += (field, x) != (field_b, y)
                elif field.endswith("heading_deg"):
                    headings.append(abs((x - y + 180.0) % 360.0 - 180.0))
                else:
                    worst[field] = max(worst.get(field, 0.0), difference(x, y))
    equal = sum(1 for _, differ in runs.values() if not differ)
    print(f"{equal} of {len(runs)} runs have the same bits; {total - sum(d for _, d in runs.values())} of {total} readings")
    if equal == len(runs):
        return 0
    if headings:
        print(f"  headings differ by up to {max(headings):.2g} deg")
    for field, most in sorted(worst.items(), key=lambda it: -it[1])[:6]:
        print(f"  {field}: relative difference up to {most:.2g}")
    print(f"  words, whole numbers or fields that are there differ in {other} places")
    soonest = min(first, key=first.get)
    print(f"  the first reading that differs is number {first[soonest]} of '{soonest}'")
    return 1


sys.exit(main(*sys.argv[1:]))
