"""Tables of pandas."""

import numpy as np
import pandas
import pytest

import magcomp

from conftest import ROOT

RECORDING = ROOT / "tests/recordings/broad_34_attached_magnet_3cm.csv.gz"


@pytest.fixture(scope="module")
def table():
    return pandas.read_csv(RECORDING, comment="#")


@pytest.fixture(scope="module")
def expected():
    return magcomp.Compensator().process(**magcomp.read_session(RECORDING))


def same(found, expected):
    for name, values in expected.items():
        if name == "status":
            assert np.array_equal(found[name], values)
        elif isinstance(values, np.ndarray):
            assert np.array_equal(found[name], values, equal_nan=True), name
        else:
            assert found[name] == values, name


def test_a_table_is_the_recording_that_it_was_read_from(table, expected):
    same(magcomp.Compensator().process(**magcomp.from_frame(table)), expected)


def test_times_may_be_a_column_of_nanoseconds_or_an_index(table, expected):
    time_ns = np.round(table["t_s"] * 1e9).astype("int64")
    rest = table.drop(columns="t_s")
    for other in (
        rest.assign(time_ns=time_ns),
        table.set_index("t_s"),
        rest.set_index(time_ns.rename("time_ns")),
        rest.set_index(pandas.to_timedelta(time_ns, unit="ns")),
        rest.set_index(pandas.to_datetime(time_ns, unit="ns")),
        rest.set_index(pandas.to_datetime(time_ns, unit="ns", utc=True)),
    ):
        same(magcomp.Compensator().process(**magcomp.from_frame(other)), expected)


def test_sensors_of_their_own_rows_are_the_same(table, expected):
    letters = [["t_s", *(letter + axis for axis in "xyz")] for letter in "mga"]
    below = pandas.concat([table[names] for names in letters])
    same(magcomp.Compensator().process(**magcomp.from_frame(below)), expected)


def test_gaps_of_pandas_own_kinds_are_gaps(table, expected):
    letters = [["time_ns", *(letter + axis for axis in "xyz")] for letter in "mga"]
    whole = table.assign(time_ns=np.round(table["t_s"] * 1e9).astype("uint64")).drop(columns="t_s")
    below = pandas.concat([whole[names] for names in letters]).convert_dtypes()
    assert below["mx"].isna().any() and str(below["mx"].dtype) == "Float64" and str(below["time_ns"].dtype) == "UInt64"
    same(magcomp.Compensator().process(**magcomp.from_frame(below)), expected)


def test_answers_become_a_table(table, expected):
    session = magcomp.from_frame(table)
    frame = magcomp.to_frame(session["time_ns"], expected)
    assert frame.index.name == "time_ns" and np.array_equal(frame.index, session["time_ns"])
    assert np.array_equal(frame[[f"field_{axis}_ut" for axis in "xyz"]], expected["field_ut"], equal_nan=True)
    assert np.array_equal(frame["heading_deg"], expected["heading_deg"], equal_nan=True)
    assert frame["status"].iloc[-1] == expected["status"][-1]
    assert frame.attrs == {"events": expected["events"], "left_out": expected["left_out"]}


@pytest.mark.parametrize(
    "change, says",
    [
        (lambda it: it.drop(columns="t_s"), "there are no times"),
        (lambda it: it.drop(columns="my"), "magnetometer needs the columns mx, my, mz; missing: my"),
        (lambda it: it.drop(columns=["gx", "gz"]), "gyroscope needs .* missing: gx, gz"),
        (lambda it: it.assign(time_ns=it["t_s"]), "whole nanoseconds"),
        (lambda it: it.assign(time_ns=pandas.array([None] * len(it), "Int64")), "missing"),
        (lambda it: it.assign(time_ns=np.uint64(2**63)), "beyond 2\\^63"),
        (lambda it: it.assign(t_s=np.nan), "no number"),
        (lambda it: it.assign(t_s=1e300), "too far from zero"),
        (lambda it: it.set_index(pandas.DatetimeIndex([pandas.NaT] * len(it))).drop(columns="t_s"), "missing"),
    ],
)
def test_tables_that_do_not_fit_are_refused(table, change, says):
    with pytest.raises(magcomp.MagcompError, match=says):
        magcomp.from_frame(change(table.head(100)))


def test_without_a_gyroscope_there_is_none(table):
    session = magcomp.from_frame(table.drop(columns=["gx", "gy", "gz"]))
    assert session["rotation_rate"] is None and session["up"] is not None
