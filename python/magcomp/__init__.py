"""magcomp frees a smartphone's magnetometer from the magnetic disturbance that the phone carries, while it is in use.

A raw magnetometer reads ``h_m = M h + b``: the Earth's field h, squeezed by soft iron M and shifted by hard iron b. A `Compensator` finds
M and b from the stream, again whenever they change, and answers each sample with the field, the heading and their standard deviations.

>>> import numpy as np, magcomp
>>> time_ns = np.arange(0, 10_000_000_000, 10_000_000)
>>> east, north = np.linspace(0, 40, 1000), np.sin(np.linspace(0, 15, 1000))
>>> direction = np.stack([np.cos(east) * np.cos(north), np.sin(east) * np.cos(north), np.sin(north)], axis=1)
>>> compensator = magcomp.Compensator()
>>> answers = compensator.process(time_ns, 48 * direction + [20, -30, 40])
>>> answers["status"][-1].item()
'tracking'
>>> compensator.calibration.hard_iron_ut.round(1).tolist()
[20.0, -30.0, 40.0]

A recording of a phone logger goes in as it is: ``compensator.process(**magcomp.read_session("session.zip"))``.

Axes are the phone's: x right, y up along the screen, z out of the screen. Fields are in microtesla, rates of turn in rad/s, `up` in m/s^2
as an accelerometer reads it at rest (up, not down), times in whole nanoseconds of one clock.
"""

from ._frames import from_frame, to_frame
from ._magcomp import (
    Calibration,
    CalibrationError,
    Compensator,
    ConfigError,
    EllipsoidFit,
    EventError,
    FitError,
    KeptError,
    MagcompError,
    Many,
    PlaceError,
    Reading,
    SessionError,
    __version__,
    earth_field,
    fit_ellipsoid,
    read_session,
)
from ._many import process_many
from ._status import EventKind, HeadingAid, Status
from ._settings import HeadingSettings, Settings
from ._types import Answers, Session

__all__ = [
    "Answers",
    "Calibration",
    "CalibrationError",
    "Compensator",
    "ConfigError",
    "EllipsoidFit",
    "EventError",
    "EventKind",
    "FitError",
    "HeadingAid",
    "HeadingSettings",
    "KeptError",
    "MagcompError",
    "Many",
    "PlaceError",
    "Reading",
    "Session",
    "SessionError",
    "Settings",
    "Status",
    "__version__",
    "earth_field",
    "fit_ellipsoid",
    "from_frame",
    "process_many",
    "read_session",
    "to_frame",
]
