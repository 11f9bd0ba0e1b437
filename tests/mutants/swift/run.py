#!/usr/bin/env python3
"""Breaks a copy of the Swift package by one patch at a time and expects the tests that the patch names to fail.

`run.py FOLDER PATCHES WORD -- SWIFT...`: FOLDER is the copy, SWIFT... the command `swift`. One build holds all patches: each function's body is there once for
every patch in it, behind the patch's number, which `MAGCOMP_MUTANT` switches on. A patch that does not apply or does not compile is an error of the list. An
assertion has to fail: tests that crash, hang for ten minutes or fail by their suite's time limit alone are no kill.
"""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

folder, patches, word = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3]
swift = sys.argv[sys.argv.index("--") + 1 :]
sources = folder / "ios/Sources/Magcomp"
modifier = r"(?:@\w+(?:\([^)]*\))?|public|private|fileprivate|package|static|final|override|mutating|nonisolated|convenience)\s+"
has_body = re.compile(rf"\s*(?:{modifier})*(func|init|deinit|get|set|didSet|var)\b", re.S)


def read(text):
    """(file, suites, what breaks, what is there, what comes in its place) of each patch."""
    for part in re.split(r"^@ ", text, flags=re.M)[1:]:
        head, *lines = part.rstrip().split("\n")
        named, what = head.split(": ", 1)
        file, *suites = named.split()
        sides = {sign: "\n".join(line[2:] for line in lines if line[:1] == sign) for sign in "-+"}
        yield file, suites, what, sides["-"], sides["+"]


def string_end(text, at):
    """Where a text literal ends that begins here."""
    marks = re.match(r'(#*)("""|")', text[at:])
    hashes, end = marks[1], marks[2] + marks[1]
    at += len(marks[0])
    while not text.startswith(end, at):
        if text.startswith(f"\\{hashes}(", at):
            at, depth = at + len(hashes) + 2, 1
            while depth:
                depth += {"(": 1, ")": -1}.get(text[at], 0)
                at = string_end(text, at) if text[at] == '"' else at + 1
        else:
            at += len(hashes) + 2 if text.startswith(f"\\{hashes}", at) else 1
    return at + len(end)


def bodies(text):
    """From where to where the body of each function is."""
    opened, at = [], 0
    while at < len(text):
        if text.startswith("//", at):
            at = text.index("\n", at)
        elif re.match(r'#*"', text[at : at + 9]):
            at = string_end(text, at)
            continue
        elif text[at] == "{":
            opened.append(at)
        elif text[at] == "}":
            begin = opened.pop()
            # the declaration begins at the indentation of its end; only a signature of several lines has a parenthesis there
            indentation = re.match(" *", text[text.rfind("\n", 0, at) + 1 :])[0]
            line = text.rfind("\n", 0, begin) + 1
            while re.match(rf"{indentation}(?: |\))", text[line:]):
                line = text.rfind("\n", 0, line - 1) + 1
            named = has_body.match(text[line:begin])
            is_stored = named and named[1] == "var" and ("=" in text[line:begin] or re.match(r"\s*(get|set|didSet)\b", text[begin + 1 : at]))
            if named and not is_stored:
                yield begin + 1, at
        at += 1


def embed(text, patches):
    """The source with patches (number, what is there, what comes in its place), and the numbers of those that have no place."""
    functions, found, nowhere = list(bodies(text)), {}, []
    for number, there, instead in patches:
        begin = text.find(there)
        end = begin + len(there)
        named, brace, _ = there.partition("{")
        if brace and there.endswith("}") and instead.endswith("}") and instead.startswith(named + brace):
            begin, end, instead = begin + len(named) + 1, end - 1, instead[len(named) + 1 : -1]
        # a function in a function is part of that
        place = min(((one, other) for one, other in functions if one <= begin and end <= other), default=None)
        value = re.fullmatch(r"((?:\w+ )*let \w+) = (.*)", there)
        if text.count(there) != 1 or not (place or value and instead.startswith(f"{value[1]} = ")):
            nowhere.append(number)
        elif place:
            found.setdefault(place, []).append((number, text[place[0] : begin] + instead + text[end : place[1]]))
        else:
            other = instead.removeprefix(f"{value[1]} = ")
            found[begin, end] = f"{value[1]} = mutant == {number} ? {other} : {value[2]}"
    for (begin, end), broken in sorted(found.items(), reverse=True):
        if not isinstance(broken, str):
            whole = text[begin:end]
            broken = "\n" + "".join(f"if mutant == {number} {{{body}\n}} else " for number, body in broken) + f"{{{whole}\n}}\n"
        text = text[:begin] + broken + text[end:]
    return text, nowhere


def run(arguments, number=0):
    """Whether it passed, and what it said; nothing where it hung."""
    # a group of its own: a run that hangs is ended with all that it has begun
    found = subprocess.Popen(
        [*swift, *arguments], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
        start_new_session=True, env={**os.environ, "MAGCOMP_MUTANT": str(number)},
    )
    try:
        out, _ = found.communicate(timeout=600)
    except subprocess.TimeoutExpired:
        os.killpg(found.pid, signal.SIGKILL)
        found.communicate()
        return False, None
    return found.returncode == 0, out


def test(suites, number=0):
    return run(["test", "--skip-build", "--no-parallel", "--filter", "|".join(suites)], number)


def judge(suites, number):
    """What became of a patch, and the tests that failed."""
    passed, out = test(suites, number)
    if passed or out is None:
        return "SURVIVED" if passed else "HUNG", []
    issues = re.findall(r"Test (\w+)\(.*? recorded an issue(.*)", out)
    # what never happens shows in nothing but a wait, of `eventually`
    waited = sorted({f"{test} waits in vain" for test, issue in issues if "deadline" in issue})
    failed = sorted({test for test, issue in issues if not re.search("Time limit was exceeded|deadline", issue)}) or waited
    return "killed" if failed else "LIMIT" if issues else "CRASHED", failed


all_patches = {
    number: patch
    for number, patch in enumerate(read(patches.read_text()), 1)
    if re.search(word, " ".join([patch[0], *patch[1], patch[2]]))
}
results = {}
for file in sorted({patch[0] for patch in all_patches.values()}):
    path = sources / f"{file}.swift"
    whole, nowhere = embed(path.read_text(), [(n, patch[3], patch[4]) for n, patch in all_patches.items() if patch[0] == file])
    path.write_text(whole)
    for number in nowhere:
        print(f"ERROR     {file}: {all_patches.pop(number)[2]}: what is taken out is not there once, or in no function")
        results.setdefault(file, []).append("ERROR")
(sources / "Mutant.swift").write_text(
    'import Foundation\n\nlet mutant = ProcessInfo.processInfo.environment["MAGCOMP_MUTANT"].flatMap { Int($0) }\n'
)
passed, out = run(["build", "--build-tests"])
if passed:
    passed, out = test(sorted({suite for patch in all_patches.values() for suite in patch[1]}))
if not passed:
    said = "\n".join(line for line in (out or "").splitlines() if "error: " in line or "recorded an issue" in line)
    sys.exit(f"{said or (out or '')[-3000:]}\nmutants: it does not build, or the tests fail before anything is broken")
for number, (file, suites, what, _, _) in all_patches.items():
    result, failed = judge(suites, number)
    results.setdefault(file, []).append(result)
    by = f" ({', '.join(failed[:3])})" if failed else ""
    print(f"{result:9} {file}: {what}{by}", flush=True)
for file, found in sorted(results.items()):
    print(f"| {file} | {len(found)} | {found.count('killed')} |")
killed, all_found = (sum(map(count, results.values())) for count in (lambda found: found.count("killed"), len))
print(f"mutants: {killed} of {all_found} killed")
sys.exit(killed < all_found)
