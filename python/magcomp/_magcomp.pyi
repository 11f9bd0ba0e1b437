import datetime
import os
from collections.abc import Callable
from typing import Any, final

import numpy as np
import pandas
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack

from ._status import EventKind, HeadingAid, Status
from ._settings import Settings
from ._types import Answers, North, Session

__version__: str
__all__ = [
    "Calibration",
    "CalibrationError",
    "Compensator",
    "ConfigError",
    "EllipsoidFit",
    "EventError",
    "FitError",
    "KeptError",
    "MagcompError",
    "Many",
    "PlaceError",
    "Reading",
    "SessionError",
    "__version__",
    "earth_field",
    "fit_ellipsoid",
    "read_session",
]

class MagcompError(ValueError):
    """What magcomp refuses, and what to do. What was learned so far stays."""

class ConfigError(MagcompError):
    """A setting that is not known, or outside its range."""

class CalibrationError(MagcompError):
    """M, b or |h| that no calibration can have."""

class EventError(MagcompError):
    """A gyroscope or gravity sample that is left out."""

class FitError(MagcompError):
    """Points that no ellipsoid fits."""

class KeptError(MagcompError):
    """A kept calibration that cannot be read."""

class SessionError(MagcompError):
    """A recording or session that cannot be read."""

class PlaceError(MagcompError):
    """A place or day for which there is no field of the Earth."""

@final
class Calibration:
    """``h_m = M h + b``."""

    def __new__(cls, soft_iron: ArrayLike, hard_iron_ut: ArrayLike, field_strength_ut: float) -> Calibration:
        """M, shape (3, 3), symmetric, no unit; b, shape (3,), uT; |h|, uT, above 0. Raises `CalibrationError`."""
    @property
    def soft_iron(self) -> NDArray[np.float64]:
        """M, shape (3, 3)."""
    @property
    def hard_iron_ut(self) -> NDArray[np.float64]:
        """b, shape (3,), uT."""
    @property
    def field_strength_ut(self) -> float:
        """|h|, uT."""
    def correct(self, raw_ut: ArrayLike) -> NDArray[np.float64]:
        """``M^-1 (h_m - b)`` of raw samples, shape (n, 3), uT."""
    def distort(self, field_ut: ArrayLike) -> NDArray[np.float64]:
        """``M h + b`` of fields, shape (n, 3), uT: what the sensor would read."""

@final
class Reading:
    """What one magnetic sample was answered with. None: not known yet, or not formed from such sensors."""

    @property
    def time_ns(self) -> int: ...
    @property
    def field_ut(self) -> NDArray[np.float64] | None:
        """The corrected sample, device frame, shape (3,), uT."""
    @property
    def filtered_field_ut(self) -> NDArray[np.float64] | None:
        """The field that the filter carries with the gyroscope, shape (3,), uT."""
    @property
    def field_sigma_ut(self) -> float | None:
        """Standard deviation of `field_ut` per axis, uT."""
    @property
    def heading_deg(self) -> float | None:
        """Clockwise from magnetic north, 0 to 360 deg, of the axis that `heading.axis` names."""
    @property
    def heading_sigma_deg(self) -> float | None:
        """Its standard deviation, deg."""
    @property
    def true_heading_deg(self) -> float | None:
        """From true north, where `heading.declination_deg` is set."""
    @property
    def direction_sigma_deg(self) -> float | None:
        """Expected direction error of the calibration over all directions, deg."""
    @property
    def status(self) -> Status: ...
    @property
    def status_text(self) -> str:
        """The same as a sentence that says what is missing or what to do."""
    @property
    def event(self) -> tuple[EventKind, int, int] | None:
        """The latest change, since when and when it was decided, ns."""

@final
class Compensator:
    """Finds M and b from a stream, again whenever they change. Not for two threads at a time."""

    def __new__(cls, **settings: Unpack[Settings]) -> Compensator:
        """Settings by name, as `config` prints them: ``Compensator(method="Adaptive", rail_ut=1200.0)``; those of a group as a dict:
        ``heading={"declination_deg": 3.2}``. Each has a default. Raises `ConfigError`."""
    @property
    def config(self) -> Settings:
        """All settings."""
    def reset(self) -> None:
        """As new, with the same settings."""
    def push_rotation_rate(self, time_ns: int, rate_rad_s: ArrayLike) -> None:
        """A gyroscope's sample, shape (3,), rad/s. Push it before the magnetic sample of its time. Raises `EventError`."""
    def push_up(self, time_ns: int, up_m_s2: ArrayLike) -> None:
        """An accelerometer's or gravity sample, shape (3,), m/s^2, up at rest. Raises `EventError`."""
    def push_heading(
        self, time_ns: int, heading_deg: float, sigma_deg: float, *, north: North = "true", axis: ArrayLike | None = None
    ) -> None:
        """A heading from outside: a GNSS course, a landmark; degrees clockwise from ``"true"`` or ``"magnetic"`` north, -360 to 360, and its
        standard deviation, above 0, up to 180. `axis`, shape (3,), is what points there, device axes: the top edge is ``[0, 1, 0]``; None: a
        vehicle in which the device lies. It may come up to 5 s late. Without a gyroscope it is not used. Raises `EventError`."""
    def push_attitude(
        self, time_ns: int, to_world: ArrayLike, *, north: North | None = None, sigma_deg: float | None = None
    ) -> None:
        """An orientation from outside, a camera's pose: the quaternion (w, x, y, z) that takes device axes to a world whose z points up. While
        the gyroscope is missing its turns stand in for it. Where the world's y axis points north, `north` says to which, `sigma_deg` how
        well: it is a heading too. Raises `EventError`."""
    @property
    def heading_aid(self) -> HeadingAid | None:
        """What headings from outside are worth after the latest sample: ``used`` (they agree), ``leads`` (north is what they say),
        ``disagrees`` (the latest one is ignored); None where none came in the last two minutes."""
    @property
    def found_declination_deg(self) -> tuple[float, float] | None:
        """The declination that headings from true north have shown, deg, east positive, and its standard deviation; None before the first,
        and while `heading.declination_deg` is set."""
    def push(self, time_ns: int, field_ut: ArrayLike) -> Reading:
        """A raw magnetic sample, shape (3,), uT. One that is refused has the status ``rejected``, and changes nothing."""
    def process(
        self,
        time_ns: ArrayLike,
        field_ut: ArrayLike,
        *,
        rotation_rate: tuple[ArrayLike, ArrayLike] | None = None,
        up: tuple[ArrayLike, ArrayLike] | None = None,
    ) -> Answers:
        """A recording: magnetic samples, shapes (n,) ns and (n, 3) uT, and ``(time_ns, values)`` of the other sensors at times and rates
        of their own. They are pushed in the order of their times; `left_out` counts gyroscope and gravity samples that were refused. It
        continues where the last call ended. Other threads run meanwhile. Ctrl-C ends it between two samples; those before have been taken. Raises `MagcompError` before
        anything is pushed."""
    @property
    def calibration(self) -> Calibration | None:
        """M, b and |h| in force."""
    @property
    def covariance(self) -> NDArray[np.float64] | None:
        """Covariance of [b_x b_y b_z (uT), m_xx m_yy m_zz m_xy m_xz m_yz], shape (9, 9)."""
    def keep(self, unix_time_s: int) -> str | None:
        """The calibration as a text for the next launch; None before anything was learned."""
    def adopt(self, kept: str, unix_time_s: int | None = None) -> None:
        """Begins with a kept text, as sure as its age makes it. Raises `KeptError`."""
    def __reduce__(self) -> tuple[Any, ...]:
        """A compensator is pickled with all that it has learned, for the same version of magcomp: another raises `MagcompError`."""
    def __copy__(self) -> Compensator: ...
    def __deepcopy__(self, _memo: Any) -> Compensator: ...

@final
class EllipsoidFit:
    """An ellipsoid fit of raw samples."""

    @property
    def calibration(self) -> Calibration: ...
    @property
    def covariance(self) -> NDArray[np.float64]:
        """Of [b (uT), m_xx m_yy m_zz m_xy m_xz m_yz], shape (9, 9)."""
    @property
    def residual_rms_ut(self) -> float:
        """Root mean square distance of the samples from the ellipsoid, uT."""
    @property
    def direction_sigma_deg(self) -> float:
        """Expected direction error over all directions, deg."""
    @property
    def samples(self) -> int: ...

@final
class Many:
    """The answers of `process_many`, recording after recording: a column ``recording``, ``time_ns``, ``status`` and those of
    `Compensator.process`. Arrow's PyCapsule interface is how others read it without a copy: ``pyarrow.table(many)``, ``polars.DataFrame(many)``."""

    @property
    def recordings(self) -> list[str]:
        """Those that were answered."""
    @property
    def errors(self) -> dict[str, str]:
        """Why the others were not."""
    @property
    def warnings(self) -> dict[str, list[str]]:
        """What was lost, left out or may be wrong."""
    @property
    def events(self) -> dict[str, list[tuple[EventKind, int, int]]]:
        """Changes, as of `Compensator.process`."""
    @property
    def left_out(self) -> dict[str, int]:
        """Gyroscope and gravity samples that were refused."""
    def to_pandas(self) -> pandas.DataFrame:
        """The answers as a table; NaN: none. ``recording`` and ``status`` are categories."""
    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any: ...
    def __len__(self) -> int:
        """Rows."""

def _compensator(version: str, state: bytes) -> Compensator: ...
def _process_many(
    recordings: list[tuple[str, Any]],
    settings: Settings,
    workers: int,
    results: str | os.PathLike[str] | None,
    progress: Callable[[int, int, int], object] | None,
) -> Many: ...
def fit_ellipsoid(points_ut: ArrayLike, *, field_strength_ut: float | None = None) -> EllipsoidFit:
    """One fit of raw samples, shape (n, 3), uT, at least 9. |h| in uT where it is known. Raises `FitError`."""

def read_session(*paths: str | os.PathLike[str]) -> Session:
    """A recording of the command `magcomp`, or a phone logger's session (zip, folder, CSV, JSON, Parquet, Arrow, MCAP), or its files. Axes and
    units are made the phone's and SI; what was lost, left out or may be wrong (units, axes, signs, clocks) is a warning. Several recordings, or a
    file that holds several, are none: raises `SessionError`, as for what cannot be read."""

def earth_field(
    latitude_deg: float, longitude_deg: float, date: datetime.date | str, *, height_m: float = 0.0
) -> tuple[float, float, float]:
    """The world magnetic model: total field, uT, dip below the horizon, deg, and declination, deg, east positive. The date is one of 2020 to
    2029, or its text YYYY-MM-DD; the height is above the ellipsoid, m. Raises `PlaceError`."""
