"""Types of settings and answers, which an editor completes and a type checker knows."""

from __future__ import annotations

import typing

import numpy as np
from numpy.typing import NDArray

from ._status import EventKind

Method = typing.Literal["Auto", "Aided", "Adaptive", "Windowed", "Constant"]
North = typing.Literal["true", "magnetic"]


class HeadingSettings(typing.TypedDict, total=False):
    """How headings are reported."""

    axis: typing.Literal["TopEdge", "Camera", "Auto"]
    screen_rotation: typing.Literal["Deg0", "Deg90", "Deg180", "Deg270"]
    declination_deg: float | None
    tilt_sigma_deg: float


class WindowedSettings(typing.TypedDict, total=False):
    """The paper's method."""

    n_min: int
    n_max: int
    sigma_th: float
    normalisation: typing.Literal["HalfRange", "EvenSphere"]
    residual: typing.Literal["Corrected", "Algebraic"]
    noise_floor_ut: float


class InitialCalibration(typing.TypedDict):
    """A calibration to begin with: M row by row, 9 numbers; b, 3 numbers, uT; |h|, uT."""

    soft_iron: typing.Sequence[float]
    hard_iron_ut: typing.Sequence[float]
    field_strength_ut: float


class Settings(typing.TypedDict, total=False):
    """Settings of a `Compensator`; each has a default, which `Compensator().config` tells.

    `method`: Auto (gyroscope and gravity beside the magnetometer), Aided (the same), Adaptive (the magnetometer alone), Windowed (the paper's) or
    Constant (one fit, then kept). `initial_sigma_ut`: standard deviation of `initial`'s hard iron, 0.01 to 1000 uT. `range_ut`: the largest component
    of a raw sample, 1 to 100000 uT. `rail_ut`: the sensor's full scale, 1 to 100000 uT; None: it is found. `field_strength_ut`: |h| where it is known,
    1 to 1000 uT. `heading["declination_deg"]`: east positive, gives `true_heading_deg`.
    """

    method: Method
    initial: InitialCalibration | None
    initial_sigma_ut: float
    range_ut: float
    rail_ut: float | None
    field_strength_ut: float | None
    heading: HeadingSettings
    windowed: WindowedSettings


class Answers(typing.TypedDict):
    """Arrays of n answers; NaN: none."""

    field_ut: NDArray[np.float64]
    filtered_field_ut: NDArray[np.float64]
    field_sigma_ut: NDArray[np.float64]
    heading_deg: NDArray[np.float64]
    heading_sigma_deg: NDArray[np.float64]
    true_heading_deg: NDArray[np.float64]
    direction_sigma_deg: NDArray[np.float64]
    status: NDArray[np.str_]
    events: list[tuple[EventKind, int, int]]
    left_out: int


class Session(typing.TypedDict):
    """What `Compensator.process` takes: times in ns, values of shape (n, 3); None for a sensor that was not recorded."""

    time_ns: NDArray[np.int64]
    field_ut: NDArray[np.float64]
    rotation_rate: tuple[NDArray[np.int64], NDArray[np.float64]] | None
    up: tuple[NDArray[np.int64], NDArray[np.float64]] | None
