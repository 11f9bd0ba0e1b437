# made by bindings/generate.sh from bindings/config.toml
"""The settings and what they choose from, as types."""

from __future__ import annotations

import typing

Method = typing.Literal[
    "Auto",  # Gyroscope and gravity beside the magnetometer; works as `Adaptive` while there is no usable gyroscope.
    "Aided",  # As `Auto` in far less memory: without a usable gyroscope it keeps its calibration, and learns nothing.
    "Adaptive",  # The magnetometer alone: notices changes, and relearns them as fast as the samples allow.
    "Windowed",  # The paper's: an ellipsoid fit over the latest samples, whose number follows sigma_T.
    "Constant",  # The first step of the paper's method alone: one fit of the first well spread samples, kept from then on.
]
"""How the hard and soft iron are estimated."""

ReferenceAxis = typing.Literal[
    "TopEdge",  # Top edge of the screen, +y.
    "Camera",  # Back camera, -z.
    "Auto",  # The horizontal direction between top edge and camera: no flip when the phone passes upright.
]
"""The axis of the device whose heading is reported."""

ScreenRotation = typing.Literal[
    "Deg0",  # Natural orientation: portrait on phones.
    "Deg90",  # Landscape, the device turned counter-clockwise: the screen's top is the device's right edge.
    "Deg180",  # Upside down.
    "Deg270",  # The other landscape: the screen's top is the device's left edge.
]
"""How the screen's content is turned against the device's natural orientation, as Android's `Display.getRotation`."""

Residual = typing.Literal[
    "Algebraic",  # Eq. (10) of the paper as written. Biased in scale by about 3 nu^2 (nu: noise over field strength), and in everything when the sphere is only partly covered.
    "Corrected",  # Divided by its own gradient: a distance in raw units, free of the noise bias.
]
"""The residual that a fit squares and sums."""

Normalisation = typing.Literal[
    "HalfRange",  # By half the range of each axis, 180 and 90 degrees: even orientations give 0.723, and so N = 626 of 100 to 2000.
    "EvenSphere",  # By sqrt(2) times the standard deviation of evenly spread directions, which so give 1.
]
"""How the standard deviations in sigma_T, eq. (15), are normalised."""


class InitialCalibration(typing.TypedDict):
    """A calibration to begin with: M row by row, 9 numbers; b, 3 numbers, uT; |h|, uT."""

    soft_iron: typing.Sequence[float]
    hard_iron_ut: typing.Sequence[float]
    field_strength_ut: float


class WindowedSettings(typing.TypedDict, total=False):
    """The paper's method (section IV, fig. 3). A field left out is the default."""

    n_min: int
    """N_min, samples, 9 to N_max: the shortest window, and what sigma_T looks at. Default 100; smaller follows changes sooner with more noise."""

    n_max: int
    """N_max, samples, at most 100 000: the longest window. Default 2000; larger is steadier under poor motion and slower to forget."""

    sigma_th: float
    """sigma_th, dimensionless, 0 to 10: below it nothing is updated. Default 0.1."""

    normalisation: Normalisation
    """How the standard deviations in sigma_T are normalised. Default `HalfRange`."""

    residual: Residual
    """The residual that fits square and sum. Default `Corrected`. `Algebraic` follows the paper as written: a window is fitted however far its samples lie from one ellipsoid."""

    noise_floor_ut: float
    """Least white noise, microtesla per axis, 0 to 1000, for which a fit is judged. Default 5; smaller accepts poorer coverage where the residual is small."""


class HeadingSettings(typing.TypedDict, total=False):
    """How headings are reported. A field left out is the default."""

    axis: ReferenceAxis
    """The axis whose heading it is. Default `TopEdge`."""

    screen_rotation: ScreenRotation
    """How the screen's content is turned against the device. Default `Deg0`, not at all."""

    declination_deg: float | None
    """Declination, degrees, east positive, -180 to 180: gives `true_heading_deg`. Default none."""

    tilt_sigma_deg: float
    """Standard deviation of `up` at rest, degrees, 0 to 90, for `heading_sigma_deg`; what motion adds to gravity comes on top. Default 0.5."""


class Settings(typing.TypedDict, total=False):
    """All settings of a compensator. A setting left out has its default. `Compensator().config` tells the defaults."""

    method: Method
    """How the hard and soft iron are estimated. Default `Auto`."""

    initial: InitialCalibration | None
    """A calibration to begin with, from elsewhere; that of the last launch is for `adopt_kept`. Default none."""

    initial_sigma_ut: float
    """One standard deviation of each component of `initial`'s hard iron, microtesla, 0.01 to 1000. Default 2; larger makes the first headings less sure, and learning faster."""

    range_ut: float
    """Largest component of a raw sample, microtesla, 1 to 100 000; a larger one is rejected. Default 2000; larger accepts stronger magnets."""

    rail_ut: float | None
    """The magnetometer's full scale, microtesla (Android: `Sensor.getMaximumRange`). A component at or beyond it is rejected as saturated. 1 to 100 000. Default none: it is found once an axis has read the same extreme again and again in motion."""

    field_strength_ut: float | None
    """The field's strength, microtesla, 1 to 1000, where it is known (the geomagnetic model gives it): then the soft iron carries the sensor's scale. Every method listens to it. Default none: found by the method."""

    heading: HeadingSettings
    """How headings are reported."""

    windowed: WindowedSettings
    """The paper's method."""
