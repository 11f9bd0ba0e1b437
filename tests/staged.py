#!/usr/bin/env python3
"""Checks a folder of android/stage.sh as Maven Central checks what is published: `tests/staged.py FOLDER`. Its rules:
https://central.sonatype.org/publish/requirements/. Signatures are checked by gpg, with the keys that it has."""
import hashlib
import re
import subprocess
import sys
import xml.etree.ElementTree as xml
import zipfile
from pathlib import Path

NAMESPACE = "{http://maven.apache.org/POM/4.0.0}"
TOLD = ["groupId", "artifactId", "version", "name", "description", "url", "licenses/license/name", "licenses/license/url", "developers/developer/name",
        "scm/url", "scm/connection", "scm/developerConnection"]
faults = []


def must(is_so, fault):
    if not is_so:
        faults.append(fault)


def texts(pom, path):
    return [(it.text or "").strip() for it in pom.findall("/".join(NAMESPACE + tag for tag in path.split("/")))]


def check_pom(file):
    pom = xml.parse(file).getroot()
    for path in TOLD:
        must(texts(pom, path) and all(texts(pom, path)), f"{file.name}: <{path}> is missing")
    for path in ["url", "licenses/license/url", "scm/url"]:
        must(all(it.startswith("https://") for it in texts(pom, path)), f"{file.name}: <{path}> is no address")
    must(pom.find(NAMESPACE + "parent") is None, f"{file.name}: has a parent, which is not published")
    must(not re.search(r"@[\w.]+@|\$\{", file.read_text()), f"{file.name}: a placeholder was not filled")
    version = "".join(texts(pom, "version"))
    must(re.fullmatch(r"\d+\.\d+\.\d+", version), f"{file.name}: version '{version}' is no release")
    dependencies = pom.findall(f"{NAMESPACE}dependencies/{NAMESPACE}dependency")
    must(all(texts(it, "version") and re.fullmatch(r"[\d.]+", texts(it, "version")[0]) for it in dependencies), f"{file.name}: a dependency without a version")
    place = ["".join(texts(pom, "groupId")).replace(".", "/"), "".join(texts(pom, "artifactId")), version]
    must("/".join(file.parent.parts).endswith("/".join(place)), f"{file.name}: lies elsewhere than its coordinates say")
    return version, ("".join(texts(pom, "packaging")) or "jar")


def check_jar(file, *entries):
    must(file.is_file(), f"{file.name} is missing")
    if file.is_file():
        names = zipfile.ZipFile(file).namelist()
        for entry in entries:
            must(any(re.search(entry, it) for it in names), f"{file.name} has no {entry}")


def check(folder):
    poms = sorted(folder.rglob("*.pom"))
    must(len(poms) == 2, f"{len(poms)} POMs, expected those of the AAR and of magcomp-host")
    versions = set()
    for file in poms:
        version, packaging = check_pom(file)
        versions.add(version)
        stem = str(file)[: -len(".pom")]
        held = r"^classes\.jar$" if packaging == "aar" else r"^org/magcomp/Compass\.class$"
        check_jar(Path(f"{stem}.{packaging}"), held, *(f"^META-INF/{it}$" for it in ["LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY-NOTICES"]))
        check_jar(Path(stem + "-sources.jar"), r"org/magcomp/Compass\.kt$")
        check_jar(Path(stem + "-javadoc.jar"), r"index\.html$")
    must(len(versions) == 1, f"two versions: {sorted(versions)}")
    files = [it for it in sorted(folder.rglob("*")) if it.is_file() and it.suffix not in {".asc", ".md5", ".sha1", ".sha256", ".sha512"}]
    for file in files:
        for sum_name in ["md5", "sha1", "sha256", "sha512"]:
            told = Path(f"{file}.{sum_name}")
            found = hashlib.new(sum_name, file.read_bytes()).hexdigest()
            must(told.is_file() and told.read_text().strip() == found, f"{told.name} is not its checksum")
        signature = Path(f"{file}.asc")
        is_signed = signature.is_file() and subprocess.run(["gpg", "--batch", "--quiet", "--verify", signature, file], capture_output=True).returncode == 0
        must(is_signed, f"{signature.name} is no signature of it")
    return len(files), versions


count, versions = check(Path(sys.argv[1]))
if faults:
    sys.exit("\n".join("staged: " + it for it in faults))
print(f"staged: {count} files of version {', '.join(versions)}, each with its signature and checksums")
