#!/usr/bin/env python3
"""Breaks a copy of the Swift package by one patch at a time and expects the tests that the patch names to fail.

`run.py FOLDER PATCHES WORD -- TEST...`: FOLDER is the copy, TEST... the command that builds and tests, which `--filter SUITES` is appended to. A patch that
does not apply or does not compile is an error of the list. An assertion has to fail: tests that crash, hang for ten minutes or fail by their suite's time
limit alone are no kill.
"""

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

folder, patches, word = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3]
command = sys.argv[sys.argv.index("--") + 1 :]


def read(text):
    """(file, suites, what breaks, what is there, what comes in its place) of each patch."""
    for part in re.split(r"^@ ", text, flags=re.M)[1:]:
        head, *lines = part.rstrip().split("\n")
        named, what = head.split(": ", 1)
        file, *suites = named.split()
        sides = {sign: "\n".join(line[2:] for line in lines if line[:1] == sign) for sign in "-+"}
        yield file, suites, what, sides["-"], sides["+"]


def run(suites):
    """Whether it built, whether the tests passed, and what they said."""
    # a group of its own: a run that hangs is ended with all that it has begun
    found = subprocess.Popen(
        [*command, "--filter", "|".join(suites)], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    )
    try:
        out, _ = found.communicate(timeout=600)
    except subprocess.TimeoutExpired:
        os.killpg(found.pid, signal.SIGKILL)
        found.communicate()
        raise
    return "Build complete!" in out, found.returncode == 0, out


def judge(suites):
    """What became of a patch, the tests that failed, and what the compiler said."""
    try:
        built, passed, out = run(suites)
    except subprocess.TimeoutExpired:
        return "HUNG", [], ""
    if not built:
        return "ERROR", [], "\n".join(line for line in out.splitlines() if "error: " in line)[:500]
    if passed:
        return "SURVIVED", [], ""
    issues = re.findall(r"Test (\w+)\(.*? recorded an issue(.*)", out)
    # what never happens shows in nothing but a wait, of `eventually`
    waited = sorted({f"{test} waits in vain" for test, issue in issues if "deadline" in issue})
    failed = sorted({test for test, issue in issues if not re.search("Time limit was exceeded|deadline", issue)}) or waited
    return "killed" if failed else "LIMIT" if issues else "CRASHED", failed, ""


all_patches = [patch for patch in read(patches.read_text()) if re.search(word, " ".join([patch[0], *patch[1], patch[2]]))]
built, passed, out = run(sorted({suite for patch in all_patches for suite in patch[1]}))
if not (built and passed):
    said = "\n".join(line for line in out.splitlines() if "error: " in line or "recorded an issue" in line)
    sys.exit(f"{said or out[-3000:]}\nmutants: the tests fail before anything is broken")
results = {}
for file, suites, what, there, instead in all_patches:
    path = folder / f"ios/Sources/Magcomp/{file}.swift"
    whole = path.read_text()
    if whole.count(there) != 1:
        print(f"ERROR     {file}: {what}: what is taken out is there {whole.count(there)} times")
        results.setdefault(file, []).append("ERROR")
        continue
    path.write_text(whole.replace(there, instead))
    result, failed, errors = judge(suites)
    path.write_text(whole)
    results.setdefault(file, []).append(result)
    by = f" ({', '.join(failed[:3])})" if failed else ""
    print(f"{result:9} {file}: {what}{by}", flush=True)
    if errors:
        print(errors)
for file, found in sorted(results.items()):
    print(f"| {file} | {len(found)} | {found.count('killed')} |")
killed = sum(found.count("killed") for found in results.values())
print(f"mutants: {killed} of {len(all_patches)} killed")
sys.exit(killed < len(all_patches))
