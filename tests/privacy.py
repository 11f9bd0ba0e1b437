#!/usr/bin/env python3
"""The privacy manifest against what needs a reason by Apple's list of required-reason interfaces.

`tests/privacy.py` reads the Swift sources: what they use must be declared. `tests/privacy.py IMPORTS` reads the undefined symbols of the native
library too, one a line: then what is declared must be used by one of them. Every reason must be one of its category's.
"""

import plistlib
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ROOT / "ios/Sources"
MANIFEST = SOURCES / "Magcomp/PrivacyInfo.xcprivacy"

# category: (names in Swift, symbols in C, reasons that Apple knows)
LIST = {
    "FileTimestamp": (
        r"creationDate|modificationDate|fileModificationDate|contentModificationDateKey|creationDateKey|getattrlist\w*|f?l?stat\(",
        r"stat|fstat|lstat|fstatat|getattrlist|getattrlistbulk|fgetattrlist|getattrlistat",
        {"DDA9.1", "C617.1", "3B52.1", "0A2A.1"},
    ),
    "SystemBootTime": (
        r"systemUptime|mach_absolute_time|mach_continuous_time|clock_gettime_nsec_np",
        r"mach_absolute_time|mach_continuous_time|clock_gettime_nsec_np",
        {"35F9.1", "8FFB.1", "3D61.1"},
    ),
    "DiskSpace": (
        r"volumeAvailableCapacity\w*|volumeTotalCapacity\w*|systemFreeSize|systemSize|f?statv?fs\(",
        r"statfs|statvfs|fstatfs|fstatvfs",
        {"85F4.1", "E174.1", "7D9E.1", "B728.1"},
    ),
    "ActiveKeyboards": (r"activeInputModes", r"", {"3EC4.1", "54BD.1"}),
    "UserDefaults": (r"UserDefaults", r"", {"CA92.1", "1C8F.1", "C56D.1", "AC6B.1"}),
}


def code_of(swift):
    """A source without comments. Texts stay: an interpolation is code."""
    swift = re.sub(r"/\*.*?\*/", "", swift, flags=re.DOTALL)
    return "\n".join(re.split(r"(?<!:)//", line)[0] for line in swift.splitlines())


def faults(manifest, code, imports):
    """What is wrong; `imports` is None where the library is not looked at."""
    entries = manifest["NSPrivacyAccessedAPITypes"]
    declared = {
        entry["NSPrivacyAccessedAPIType"].removeprefix("NSPrivacyAccessedAPICategory"): set(entry["NSPrivacyAccessedAPITypeReasons"])
        for entry in entries
    }
    found = [f"{name} is declared twice" for name in declared if sum(name in str(entry) for entry in entries) > 1]
    found += [f"{name} is no category of Apple's" for name in declared.keys() - LIST.keys()]
    for name, (swift, symbols, reasons) in LIST.items():
        used = sorted(set(re.findall(rf"\b(?:{swift})", code)))
        used += sorted(symbol for symbol in imports or () if symbols and re.fullmatch(rf"_(?:{symbols})(?:\$\w+)?", symbol))
        own = declared.get(name, set())
        if used and not own:
            found.append(f"{name} is not declared, or without a reason: {', '.join(used)}")
        if not used and own and imports is not None:
            found.append(f"{name} is declared and used by nobody")
        if own - reasons:
            found.append(f"{name} has reasons that Apple does not know: {', '.join(sorted(own - reasons))}")
    return found


def main():
    manifest = plistlib.loads(MANIFEST.read_bytes())
    code = "\n".join(code_of(file.read_text()) for file in sorted(SOURCES.rglob("*.swift")))
    imports = Path(sys.argv[1]).read_text().split() if len(sys.argv) > 1 else None
    # the judge itself: without its entries the manifest must not pass
    assert faults({"NSPrivacyAccessedAPITypes": []}, code, imports), "nothing that needs a reason was found in the sources"
    found = faults(manifest, code, imports)
    for fault in found:
        print(f"{MANIFEST.relative_to(ROOT)}: {fault}", file=sys.stderr)
    if found:
        sys.exit(1)
    print("privacy manifest: " + ", ".join(sorted(entry["NSPrivacyAccessedAPIType"].split("Category")[1] for entry in manifest["NSPrivacyAccessedAPITypes"])))


if __name__ == "__main__":
    main()
