"""Tables of pandas in and out. pandas is asked for when a function is called, not before."""

from __future__ import annotations

import typing

import numpy as np

from . import _magcomp
from ._types import Answers, Session

if typing.TYPE_CHECKING:
    import pandas

_SENSORS = {"magnetometer": "m", "gyroscope": "g", "accelerometer": "a"}


def _times(frame: pandas.DataFrame) -> np.ndarray:
    import pandas

    index = frame.index
    if index.name in ("time_ns", "t_s") and index.name not in frame and not isinstance(index, (pandas.DatetimeIndex, pandas.TimedeltaIndex)):
        frame = frame.reset_index()
    if "time_ns" in frame:
        if frame["time_ns"].hasnans:
            raise _magcomp.MagcompError("the column time_ns has a time that is missing; drop that row")
        time_ns = frame["time_ns"].to_numpy()
        if time_ns.dtype.kind not in "iu":
            raise _magcomp.MagcompError(f"the column time_ns is {time_ns.dtype}; it must be whole nanoseconds")
        if (time_ns > np.iinfo(np.int64).max).any():
            raise _magcomp.MagcompError("the column time_ns has times beyond 2^63 ns")
        return time_ns.astype(np.int64)
    if "t_s" in frame:
        time_s = frame["t_s"].to_numpy(dtype=np.float64, na_value=np.nan)
        if not (np.abs(time_s) < 2.0**62 * 1e-9).all():
            raise _magcomp.MagcompError("the column t_s has a time that is no number, or too far from zero; drop that row")
        return np.round(time_s * 1e9).astype(np.int64)
    if isinstance(index, (pandas.DatetimeIndex, pandas.TimedeltaIndex)):
        if index.hasnans:
            raise _magcomp.MagcompError("the index has a time that is missing; drop that row")
        if isinstance(index, pandas.DatetimeIndex):
            # zones are UTC below
            return index.to_numpy(dtype="datetime64[ns]").astype(np.int64)
        return index.to_numpy(dtype="timedelta64[ns]").astype(np.int64)
    raise _magcomp.MagcompError("there are no times; give a column or an index time_ns (whole nanoseconds) or t_s (seconds), or an index of times")


def from_frame(frame: pandas.DataFrame) -> Session:
    """What `Compensator.process` takes, of a table with named columns.

    Times are a column or an index ``time_ns`` (whole nanoseconds) or ``t_s`` (seconds), or an index of times. ``mx, my, mz`` are raw, uT;
    ``gx, gy, gz`` in rad/s and ``ax, ay, az`` in m/s^2 may be left out. A row without a sensor's values (NaN or NA) is no sample of that
    sensor; so tables of different rates can be put below one another. Other columns are not read. Raises `MagcompError`.
    """
    time_ns = _times(frame)
    found: dict[str, tuple[np.ndarray, np.ndarray] | None] = {}
    for sensor, letter in _SENSORS.items():
        names = [letter + axis for axis in "xyz"]
        there = [name for name in names if name in frame]
        if not there and letter != "m":
            found[letter] = None
            continue
        if there != names:
            missing = ", ".join(name for name in names if name not in frame)
            raise _magcomp.MagcompError(f"the {sensor} needs the columns {', '.join(names)}; missing: {missing}")
        values = frame[names].to_numpy(dtype=np.float64, na_value=np.nan)
        have = ~np.isnan(values).all(axis=1)
        found[letter] = (time_ns[have], values[have])
    magnetic = found["m"]
    assert magnetic is not None
    order = np.argsort(magnetic[0], kind="stable")
    return {"time_ns": magnetic[0][order], "field_ut": magnetic[1][order], "rotation_rate": found["g"], "up": found["a"]}


def to_frame(time_ns: np.typing.ArrayLike, answers: Answers) -> pandas.DataFrame:
    """The answers of `Compensator.process` as a table with a row for each magnetic sample; its index is ``time_ns``. The arrays of three are columns
    ``field_x_ut`` and so on. ``attrs`` has ``events`` and ``left_out``.
    """
    import pandas

    columns: dict[str, np.ndarray] = {}
    for name, values in answers.items():
        if not isinstance(values, np.ndarray):
            continue
        if values.ndim == 2:
            stem = name.removesuffix("_ut")
            columns |= {f"{stem}_{axis}_ut": values[:, k] for k, axis in enumerate("xyz")}
        else:
            columns[name] = values
    frame = pandas.DataFrame(columns, index=pandas.Index(np.asarray(time_ns), name="time_ns"))
    frame.attrs = {"events": answers["events"], "left_out": answers["left_out"]}
    return frame
