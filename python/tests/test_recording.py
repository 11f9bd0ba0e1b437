"""Python's answers are Rust's, bit for bit, on a recording."""

import csv
import gzip
import subprocess

import numpy as np
import pytest

import magcomp

from conftest import ROOT

RECORDING = ROOT / "tests/recordings/broad_34_attached_magnet_3cm.csv.gz"


def columns(lines, *names):
    rows = list(csv.DictReader(lines))
    return {name: np.array([float(row[name] or "nan") for row in rows]) for name in names or rows[0]}


def recorded(limit=None):
    with gzip.open(RECORDING, "rt") as file:
        table = columns(line for line in file if not line.startswith("#"))
    return {name: values[:limit] for name, values in table.items()}


def arrays(table):
    time_ns = np.round(table["t_s"] * 1e9).astype(np.int64)

    def sensor(letter):
        values = np.stack([table[letter + axis] for axis in "xyz"], axis=1)
        have = np.isfinite(values).all(axis=1)
        return time_ns[have], values[have]

    return sensor("m"), sensor("g"), sensor("a")


@pytest.fixture(scope="module")
def answers():
    mag, gyro, acc = arrays(recorded())
    return magcomp.Compensator().process(*mag, rotation_rate=gyro, up=acc)


def test_headings_are_those_of_the_command(answers, command, tmp_path):
    out = tmp_path / "out.csv"
    subprocess.run([command, "replay", str(RECORDING), "--output", str(out)], check=True, capture_output=True)
    with open(out) as file:
        rust = columns(file, "heading_deg", "heading_sigma_deg")
    for name in ("heading_deg", "heading_sigma_deg"):
        # the command prints a limited number of digits
        assert np.isfinite(rust[name]).sum() > 1000
        np.testing.assert_allclose(answers[name], rust[name], atol=6e-3, rtol=0, equal_nan=True)


def test_pushing_one_by_one_gives_the_same_bits(answers):
    mag, gyro, acc = arrays(recorded(3000))
    compensator = magcomp.Compensator()
    events = sorted(
        [(t, 0, v) for t, v in zip(*gyro)] + [(t, 1, v) for t, v in zip(*acc)] + [(t, 2, v) for t, v in zip(*mag)],
        key=lambda event: event[:2],
    )
    readings = []
    for time_ns, kind, value in events:
        if kind == 2:
            readings.append(compensator.push(int(time_ns), value))
        elif kind == 1:
            compensator.push_up(int(time_ns), value)
        else:
            compensator.push_rotation_rate(int(time_ns), value)
    for name in ("heading_deg", "heading_sigma_deg", "field_sigma_ut", "direction_sigma_deg"):
        one_by_one = np.array([np.nan if getattr(r, name) is None else getattr(r, name) for r in readings])
        assert np.array_equal(one_by_one, answers[name][: len(readings)], equal_nan=True), name
    assert [r.status for r in readings] == list(answers["status"][: len(readings)])


def test_a_recording_in_two_parts_is_the_same_recording(answers):
    mag, gyro, acc = arrays(recorded())
    middle = mag[0][len(mag[0]) // 2]
    compensator, headings = magcomp.Compensator(), []
    for low, high in ((-1, middle), (middle, mag[0][-1])):
        part = [(t[(t > low) & (t <= high)], v[(t > low) & (t <= high)]) for t, v in (mag, gyro, acc)]
        headings.append(compensator.process(*part[0], rotation_rate=part[1], up=part[2])["heading_deg"])
    assert np.array_equal(np.concatenate(headings), answers["heading_deg"], equal_nan=True)


def test_a_session_is_read_as_the_command_reads_it(answers):
    session = magcomp.read_session(RECORDING)
    found = magcomp.Compensator().process(**session)
    assert np.array_equal(found["heading_deg"], answers["heading_deg"], equal_nan=True)
    with pytest.raises(magcomp.SessionError, match="nowhere"):
        magcomp.read_session("nowhere.zip")


def test_a_session_without_other_sensors_has_none(tmp_path):
    alone = tmp_path / "alone.csv"
    alone.write_text("t_s,mx,my,mz\n" + "".join(f"{k * 0.02:.2f},{30 + k % 7},{k % 5},-40\n" for k in range(100)))
    session = magcomp.read_session(str(alone))
    assert session["rotation_rate"] is None and session["up"] is None
    assert len(magcomp.Compensator().process(**session)["status"]) == 100
