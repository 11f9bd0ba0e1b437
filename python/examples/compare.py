"""Headings of a recording with a magnet on the sensor: the orientation filters VQF and Madgwick's (of the package ahrs), each on raw samples
and on samples that magcomp corrected, and magcomp's own. Needs `pip install vqf ahrs`. Run it as `python compare.py RECORDING.csv.gz`; without one it takes that of the tests.

Errors are against the optical reference of the recording, up to the constant angle between both frames, in degrees rms.
"""

import csv
import gzip
import sys
from pathlib import Path

import ahrs
import numpy as np
import vqf

import magcomp

ROOT = Path(__file__).resolve().parent.parent.parent
RECORDING = ROOT / "tests/recordings/broad_34_attached_magnet_3cm.csv.gz"


def heading_deg(quaternion):
    """Of the device's y axis, clockwise from the reference's y axis, deg; quaternions w x y z, device to world."""
    w, x, y, z = np.asarray(quaternion).T
    east, north = 2 * (x * y - w * z), 1 - 2 * (x * x + z * z)
    level = np.hypot(east, north) > 0.5  # the axis is within 60 degrees of the horizontal
    return np.where(level, np.degrees(np.arctan2(east, north)), np.nan)


def rms_deg(found, reference):
    off = np.radians(found - reference)
    off = off[np.isfinite(off)]
    off = np.angle(np.exp(1j * (off - np.angle(np.exp(1j * off).mean()))))
    return np.degrees(np.sqrt(np.mean(off**2))), len(off)


def compare(path):
    session = magcomp.read_session(path)
    answers = magcomp.Compensator().process(**session)
    with gzip.open(path, "rt") as file:
        rows = [[float(row["q" + axis]) for axis in "wxyz"] for row in csv.DictReader(file)]
    reference = heading_deg(rows)
    period_s = np.median(np.diff(session["time_ns"])) * 1e-9

    # all sensors of this recording share their rows
    rate, up = (np.ascontiguousarray(session[name][1]) for name in ("rotation_rate", "up"))

    def by_vqf(magnetic):
        return heading_deg(vqf.VQF(period_s).updateBatch(rate, up, np.ascontiguousarray(magnetic))["quat9D"])

    def by_madgwick(magnetic):
        return heading_deg(ahrs.filters.Madgwick(gyr=rate, acc=up, mag=magnetic, frequency=1 / period_s).Q)

    have = np.isfinite(answers["field_ut"])
    found = {
        "VQF, raw": by_vqf(session["field_ut"]),
        "VQF, corrected by magcomp": by_vqf(np.where(have, answers["field_ut"], 0.0)),  # zeros: it goes on without
        "Madgwick, raw": by_madgwick(session["field_ut"]),
        "Madgwick, corrected by magcomp": by_madgwick(np.where(have, answers["field_ut"], session["field_ut"])),
        "magcomp": answers["heading_deg"],
    }
    # where magcomp has an answer
    judged = np.where(np.isfinite(answers["heading_deg"]), reference, np.nan)
    return {name: rms_deg(values, judged) for name, values in found.items()}


if __name__ == "__main__":
    for name, (error, count) in compare(Path(sys.argv[1]) if sys.argv[1:] else RECORDING).items():
        print(f"{name:30} {error:6.2f} deg rms, {count} headings")
