"""Types of answers, which an editor completes and a type checker knows."""

from __future__ import annotations

import typing

import numpy as np
from numpy.typing import NDArray

from ._status import EventKind

North = typing.Literal["true", "magnetic"]


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
