#!/usr/bin/env python3
"""Answers of programs that are none of ours, for `magcomp compare --recordings FOLDER --entry "NAME=OUT"`: `benchmarks/rivals.py METHOD FOLDER OUT`.

    magyc         MAGYC (S. Rodriguez-Martinez, G. Troni, IEEE Journal of Oceanic Engineering, 2025; PyPI magyc 1.0.0), its least squares over
                  the whole recording with its defaults, then VQF. It has seen the whole recording before it answers
    magyc-online  its incremental factor graph, which gives M and b that grow with the recording; each sample is corrected by the latest, then VQF
    react-native  react-native-nitro-compass 1.2.5 (MIT): the Android half written again from its published constants, on the field that the
                  phone's system has calibrated (NAME_oscal). VQF without a magnetometer stands for Android's game rotation vector

FOLDER is what benchmarks/convert.py wrote. Needs numpy, pandas and vqf, for MAGYC magyc too (which wants numpy below 2)."""

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import vqf


def columns(rows, letter):
    return np.ascontiguousarray(rows[[letter + axis for axis in "xyz"]].ffill().bfill())


def filtered(rows, field_ut):
    """VQF of a field, device to east-north-up."""
    step_s = float(np.median(np.diff(rows.t_s)))
    found = vqf.VQF(step_s).updateBatch(columns(rows, "g"), columns(rows, "a"), np.ascontiguousarray(field_ut))
    return pd.DataFrame(found["quat9D"], columns=["qw", "qx", "qy", "qz"])


def magyc(rows, *_):
    from magyc import magyc_ls

    raw_ut = columns(rows, "m")
    hard_iron_ut, soft_iron, *_ = magyc_ls(raw_ut, columns(rows, "g"), rows.t_s.to_numpy())
    return filtered(rows, (raw_ut - hard_iron_ut.reshape(1, 3)) @ np.linalg.inv(soft_iron).T)


# Samples from one optimisation of its factor graph to the next: ten windows of 25, its default.
OPTIMISED = 250


def magyc_online(rows, *_):
    from magyc import magyc_ifg

    raw_ut = columns(rows, "m")
    *_, steps = magyc_ifg(raw_ut, columns(rows, "g"), rows.t_s.to_numpy())
    corrected_ut = raw_ut.copy()
    for k, (soft_iron, hard_iron_ut) in enumerate(zip(steps["soft_iron"], steps["hard_iron"], strict=True), 1):
        after = slice(k * OPTIMISED + 1, None)
        corrected_ut[after] = (raw_ut[after] - hard_iron_ut) @ np.linalg.inv(soft_iron.reshape(3, 3)).T
    return filtered(rows, corrected_ut)


# Of its Kotlin source: bounds of a field that it trusts, smoothing of accelerometer and magnetometer by the rate of turn, share of the
# magnetic heading in each sample, and of the newest heading in what it shows.
FIELD_UT = (20.0, 70.0)
JUMP_S, JUMP_UT = 1.5, 1.0
TURNS_DEG_S = (5.0, 30.0)
MAGNETIC_SHARE, SHOWN_SHARE = 0.02, 0.2


# Rows whose top edge is steeper have no heading of it, and no answer here.
LEVEL = 0.5


def react_native(rows, system_ut, is_android):
    def wrapped(angle_deg):
        return (angle_deg + 180) % 360 - 180

    t, up, raw_ut = rows.t_s.to_numpy(), columns(rows, "a"), columns(rows, "m")
    step_s = float(np.median(np.diff(t)))
    w, x, y, z = vqf.VQF(step_s).updateBatch(columns(rows, "g"), up)["quat6D"].T
    turned_deg = np.degrees(np.arctan2(2 * (x * y - w * z), 1 - 2 * (x * x + z * z)))
    bias_ut = raw_ut - system_ut
    fused = rate = 0.0
    started = was_disturbed = False
    smooth_up, smooth_ut, shown, jumped_s = up[0], None, None, -9.0
    answers = np.full((len(t), 3), np.nan)
    for k in range(len(t)):
        if k:
            turn = wrapped(turned_deg[k] - turned_deg[k - 1])
            now = turn / max(t[k] - t[k - 1], 1e-3)
            rate = now if rate == 0 else 0.3 * now + 0.7 * rate
            fused += turn
        fast = np.clip((abs(rate) - TURNS_DEG_S[0]) / (TURNS_DEG_S[1] - TURNS_DEG_S[0]), 0, 1)
        share = 0.05 + 0.2 * fast
        smooth_up = share * up[k] + (1 - share) * smooth_up
        if not np.isfinite(system_ut[k]).all():
            continue
        share = 0.1 + 0.3 * fast
        smooth_ut = system_ut[k] if smooth_ut is None else share * system_ut[k] + (1 - share) * smooth_ut
        # Android tells its own hard iron beside the raw field
        if k and is_android and np.abs(bias_ut[k] - bias_ut[k - 1]).max() > JUMP_UT:
            jumped_s = t[k]
        strength_ut = np.linalg.norm(system_ut[k])
        disturbed = not FIELD_UT[0] <= strength_ut <= FIELD_UT[1] or t[k] - jumped_s < JUMP_S
        anew = was_disturbed and not disturbed
        if anew:
            shown, smooth_ut = None, system_ut[k]
        was_disturbed = disturbed
        east = np.cross(smooth_ut, smooth_up)
        east /= np.linalg.norm(east)
        level = smooth_up / np.linalg.norm(smooth_up)
        north = np.cross(level, east)
        magnetic_deg = np.degrees(np.arctan2(east[1], north[1]))
        if not started or anew:
            fused, started = magnetic_deg, True
        elif not disturbed:
            fused += MAGNETIC_SHARE * wrapped(magnetic_deg - fused)
        newest = np.exp(1j * np.radians(fused))
        shown = newest if shown is None else SHOWN_SHARE * newest + (1 - SHOWN_SHARE) * shown
        # its heading as a north in the device: the top edge points by that angle east of it
        off = np.angle(shown) - np.radians(magnetic_deg)
        if np.hypot(east[1], north[1]) > LEVEL:
            answers[k] = np.cos(off) * north - np.sin(off) * east
    return pd.DataFrame(answers, columns=["cx", "cy", "cz"])


METHODS = {"magyc": magyc, "magyc-online": magyc_online, "react-native": react_native}


def main():
    if len(sys.argv) != 4 or sys.argv[1] not in METHODS:
        sys.exit(__doc__)
    method, (folder, out) = METHODS[sys.argv[1]], map(Path, sys.argv[2:])
    out.mkdir(parents=True, exist_ok=True)
    for path in sorted(folder.glob("*_uncal.csv.gz")):
        rows = pd.read_csv(path)
        system_ut = pd.read_csv(folder / path.name.replace("_uncal", "_oscal"))[["mx", "my", "mz"]].to_numpy()
        method(rows, system_ut, "Nexus" in path.name).to_csv(out / path.name.removesuffix(".gz"), index=False)
        print(path.name, flush=True)


main()
