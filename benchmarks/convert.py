#!/usr/bin/env python3
"""Public data sets as recordings: `benchmarks/convert.py SET FOLDER OUT`. FOLDER is what you downloaded, OUT what `magcomp compare --recordings OUT` takes.

    broad        github.com/dlaidig/broad: FOLDER has data_mat/*.mat
    smartphones  github.com/tyrex-team/benchmarks-attitude-smartphones: FOLDER has datasets/android, datasets/ios, datasets/qualisys.
                 OUT/fused gets the headings of the phones' own fusion, for `compare --entry`
    magnet       FOLDER is an OUT of `smartphones`: a magnet is put on each phone in the middle of its recording. That is arithmetic: a
                 constant field of 27 uT is added to the raw samples and to the system's field. Past boards with magnets none is added

Needs numpy and scipy. With --only PATTERN, once or more, only the trials whose names fit (`Jakob_*`), and the calibrations."""

import argparse
import csv
import fnmatch
import gzip
import re
import sys
from pathlib import Path

import numpy as np
import scipy.io

G_M_S2 = 9.80665
COLUMNS = "t_s,mx,my,mz,ax,ay,az,gx,gy,gz,qw,qx,qy,qz"


def write(path, columns, header, digits=(4, *[3] * 3, *[4] * 3, *[5] * 3, *[6] * 4)):
    """Rows of text, so that the same input gives the same file."""
    lines = [",".join(f"{value:.{d}f}" for value, d in zip(row, digits)) for row in np.column_stack(columns)]
    with gzip.GzipFile(path, "wb", mtime=0) as file:
        file.write("\n".join([header, *lines, ""]).encode())


def quaternions(matrices):
    """Rotations as w, x, y, z without jumps of sign; nan stays nan."""
    from scipy.spatial.transform import Rotation

    found = np.full((len(matrices), 4), np.nan)
    good = np.isfinite(matrices).all((1, 2))
    found[good] = Rotation.from_matrix(matrices[good]).as_quat()[:, [3, 0, 1, 2]]
    return continuous(found)


def continuous(q):
    sign, last = 1.0, None
    out = q.copy()
    for k in np.flatnonzero(np.isfinite(q).all(1)):
        if last is not None and out[last] @ q[k] * sign < 0:
            sign = -sign
        out[k], last = sign * q[k], k
    return out


def means(times, values, at, width):
    """Means of the values over intervals of this width about the times `at`; the nearest value where an interval has none."""
    total = np.vstack([np.zeros(values.shape[1]), np.cumsum(values, 0)])
    low, high = np.searchsorted(times, at - width / 2), np.searchsorted(times, at + width / 2)
    few = high <= low
    low[few] = np.clip(np.searchsorted(times, at[few]), 0, len(times) - 1)
    high[few] = low[few] + 1
    return (total[high] - total[low]) / (high - low)[:, None]


def at_times(times, q, at):
    """Quaternions between two frames; nan beside a missing one."""
    k = np.clip(np.searchsorted(times, at) - 1, 0, len(times) - 2)
    share = ((at - times[k]) / (times[k + 1] - times[k]))[:, None]
    mixed = (1 - share) * q[k] + share * q[k + 1]
    mixed[(share[:, 0] < 0) | (share[:, 0] > 1)] = np.nan
    return mixed / np.linalg.norm(mixed, axis=1)[:, None]


def fits(name, patterns):
    return any(fnmatch.fnmatch(name, pattern) for pattern in patterns)


def index(out, rows, header="recording,group,declination_deg,magnet_s,calibration"):
    with open(out / "INDEX.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([header.split(","), *rows])


# BROAD: five samples of 285.7 Hz become one. Its reference is east-north-up by magnetic north.
MAGNETS_S = {32: "38.3-95.3", 33: "42.5-98.7", 34: "45.1-99.8", 35: "42.7-99.5", 36: "37.1-98.7"}
FIRST = "broad_01_slow_rotation_A"


def broad(folder, out, only):
    rows = []
    for path in sorted(folder.glob("data_mat/*.mat")):
        number, disturbed, name = re.fullmatch(r"(\d+)_(undisturbed|disturbed)_(.*)", path.stem).groups()
        if not fits(path.stem, only) and number != "01":
            continue
        trial = scipy.io.loadmat(path, squeeze_me=True)
        count = len(trial["imu_mag"]) // 5
        five = lambda values: values[: 5 * count].reshape(count, 5, -1).mean(1)
        q = five(continuous(trial["opt_quat"]))
        q /= np.linalg.norm(q, axis=1)[:, None]
        t = np.arange(count) * 5 / trial["sampling_rate"]
        recording = f"broad_{number}_{name}"
        write(out / f"{recording}.csv.gz", [t, *(five(trial[key]) for key in ("imu_mag", "imu_acc", "imu_gyr")), q], COLUMNS)
        magnet = MAGNETS_S.get(int(number), "")
        group = ("a magnet on the sensor" if magnet else "past a magnet that stands still" if "stationary_magnet" in name
                 else f"{disturbed}: {re.sub(r'_([A-D]|[0-9]+s)$', '', name).replace('_', ' ')}")
        rows.append([recording, group, 0, magnet, "" if number == "01" else FIRST])
        print(recording, flush=True)
    index(out, rows)


# Smartphones: the reference is east-north-up by true north, magnetic north 1.9 degrees east of it in Grenoble in 2016.
DAYS = {"2016-05-31": "d1", "2016-06-02": "d2", "2016-06-03": "d3", "2016-06-06": "d4"}


def ios_begin(folder):
    return float(re.search(r"BootTime\s*=\s*([\d.]+)", (folder / "description.txt").read_text())[1])


def sensors(folder, is_ios):
    """Times and vectors of magnetometer, the system's field, accelerometer (+g up at rest) and gyroscope."""
    begin = ios_begin(folder) if is_ios else 0.0
    streams = []
    for name in ("magnetometer", "magnetometer-calibrated", "accelerometer", "gyroscope"):
        values = np.loadtxt(folder / f"{name}.txt", usecols=range(4))
        values = values[np.concatenate([[True], np.diff(values[:, 0]) > 0])]
        scale = -G_M_S2 if is_ios and name == "accelerometer" else 1.0
        streams.append((values[:, 0] - begin, scale * values[:, 1:]))
    return streams


def motion_capture(path):
    """Times, quaternions (device to world), and on which day."""
    trial = scipy.io.loadmat(path, squeeze_me=True, struct_as_record=False)
    [trial] = [value for key, value in trial.items() if not key.startswith("__")]
    matrices = trial.RigidBodies.Rotations.reshape(9, -1).T.reshape(-1, 3, 3).transpose(0, 2, 1)
    times, q = np.arange(len(matrices)) / trial.FrameRate, quaternions(matrices)
    # where cameras lose markers, poses jump; between two jumps they may be wrong
    for k in np.flatnonzero(turn_rates(times, q) > FASTEST_RAD_S):
        q[np.abs(times - times[k]) < JUMP_S] = np.nan
    return times, q, DAYS[str(trial.Timestamp)[:10]]


def fused(folder, is_ios, at):
    """The attitude that the phone's own fusion last gave at these times, device to east-north-up by magnetic north: Android's rotation vector,
    or CMAttitude, whose world has x north, y west. An iPhone's begins with x wherever it points, and a few do not find north within two minutes."""
    path, begin = (folder / "attitude.txt", ios_begin(folder)) if is_ios else (folder / "rotation-vector.txt", 0.0)
    values = np.loadtxt(path, usecols=range(5))
    times, q = values[:, 0] - begin, values[:, 1:]
    if is_ios:
        w, x, y, z = q.T
        q = np.sqrt(0.5) * np.column_stack([w - z, x - y, x + y, w + z])
    else:
        q = q[:, [3, 0, 1, 2]]
    last = np.searchsorted(times, at, "right") - 1
    return np.where((last < 0)[:, None], np.nan, q[np.maximum(last, 0)])


FASTEST_RAD_S = 15.0
JUMP_S = 0.5


def turn_rates(times, q):
    return 2 * np.arccos(np.abs((q[1:] * q[:-1]).sum(1)).clip(0, 1)) / np.diff(times)


def clock(folder, gyroscope, times, q):
    """How much later the cameras' clock is: the authors' estimate to 10 ms, then what makes the rates of turn agree best."""
    late = float((folder / "timeAlignment.txt").read_text().split()[0])
    turning = np.convolve(turn_rates(times, q), np.ones(5) / 5, "same")
    middle = (times[1:] + times[:-1]) / 2
    rate_times, rates = gyroscope
    rates = np.linalg.norm(rates, axis=1)
    width = max(1, int(5 / 60 / np.median(np.diff(rate_times))))
    rates = np.convolve(rates, np.ones(width) / width, "same")
    tries = late + np.arange(-0.5, 0.5001, 0.002)
    good = np.isfinite(turning) & (middle > 1) & (middle < times[-1] - 1)
    agreement = [np.corrcoef(turning[good], np.interp(middle[good] - late, rate_times, rates))[0, 1] for late in tries]
    return tries[int(np.argmax(agreement))], max(agreement)


def smartphones(folder, out, only):
    rows = []
    for path in sorted(folder.glob("datasets/*/*/magnetometer.txt")):
        trial, is_ios = path.parent, path.parent.parent.name == "ios"
        is_calibration = trial.name.startswith("calib_mag_")
        if not is_calibration and (trial.name.startswith("calib_") or not fits(trial.name, only)):
            continue
        field, system, up, rate = sensors(trial, is_ios)
        width = float(np.median(np.diff(field[0])))
        if is_calibration:
            t = field[0]
            inertial = [means(*stream, t, width) for stream in (up, rate)]
            write(out / f"{trial.name}.csv.gz", [t - t[0], field[1], *inertial], COLUMNS.split(",qw")[0])
            continue
        # one trial differs in a letter's case
        cameras = [path for path in folder.glob("datasets/qualisys/*.mat") if path.stem.lower() == trial.name.lower()]
        if not cameras:
            print(f"{trial.name}: no reference", file=sys.stderr)
            continue
        [cameras] = cameras
        times, q, day = motion_capture(cameras)
        late, agreement = clock(trial, rate, times, q)
        seen = (field[0] + late >= 0) & (field[0] + late <= times[-1])
        t, field_ut = field[0][seen], field[1][seen]
        inertial = [means(*stream, t, width) for stream in (up, rate)]
        _, device, disturbed, motion = trial.name.split("_")[:4]
        group = "running" if "Running" in motion else "quiet room" if disturbed == "NoDist" else "past boards with magnets"
        name = f"{trial.name}_{day}"
        write(out / f"{name}_uncal.csv.gz", [t - t[0], field_ut, *inertial, at_times(times, q, t + late)], COLUMNS)
        k = np.clip(np.searchsorted(system[0], t, "right") - 1, 0, len(system[0]) - 1)
        write(out / f"{name}_oscal.csv.gz", [t - t[0], np.where((t < system[0][0])[:, None], np.nan, system[1][k])], "t_s,mx,my,mz")
        (out / "fused").mkdir(exist_ok=True)
        write(out / "fused" / f"{name}_uncal.csv.gz", [t - t[0], fused(trial, is_ios, t)], "t_s,qw,qx,qy,qz", (4, 6, 6, 6, 6))
        rows.append([f"{name}_uncal", group, 1.9, "", f"calib_mag_{device}_{day}"])
        print(f"{name}: clocks agree to {agreement:.3f}", flush=True)
    index(out, rows)


# The field of a cover with a magnet, in the phone's axes, uT: 27 uT in all.
MAGNET_UT = np.array([18.0, -12.0, 16.0])


def magnet(folder, out, only):
    index_rows = list(csv.reader((folder / "INDEX.csv").open()))[1:]
    rows = []
    for name, group, declination_deg, _, calibration in index_rows:
        trial = name.removesuffix("_uncal")
        if group.startswith("past boards") or not fits(trial, only):
            continue
        on_s = None
        for half in ("uncal", "oscal"):
            with gzip.open(folder / f"{trial}_{half}.csv.gz", "rt") as file:
                header = file.readline().strip()
                values = np.loadtxt(file, delimiter=",")
            if on_s is None:
                on_s = round(float(values[0, 0] + values[-1, 0]) / 2, 1)
            values[values[:, 0] >= on_s, 1:4] += MAGNET_UT
            write(out / f"{trial}_{half}.csv.gz", [values], header)
        rows.append([name, f"{group}, a magnet put on", declination_deg, f"{on_s}-{values[-1, 0]}", "", on_s])
        print(f"{trial}: from {on_s} s on", flush=True)
    index(out, rows, "recording,group,declination_deg,magnet_s,calibration,judged_s")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("set", choices=["broad", "smartphones", "magnet"])
    parser.add_argument("folder", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--only", action="append", metavar="PATTERN")
    chosen = parser.parse_args()
    chosen.out.mkdir(parents=True, exist_ok=True)
    {"broad": broad, "smartphones": smartphones, "magnet": magnet}[chosen.set](chosen.folder, chosen.out, chosen.only or ["*"])


main()
