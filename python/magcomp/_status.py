# made by bindings/generate.sh from bindings/status.toml
"""The words of a status, of an event and of what headings from outside are worth, as types."""

import typing

Status = typing.Literal[
    "collecting",  # There is no calibration yet.
    "tracking",  # Calibrated, and following changes.
    "suspect",  # Something changed; it is not yet decided whether the device or the place.
    "held",  # Calibrated, but not learning: the calibration is kept.
    "disturbed",  # The place is disturbed, not the device: the calibration is kept, and after 30 s learned on in the field of that place.
    "rejected",  # This sample was not used, and changed nothing; 50 in a row that agree on another clock begin that clock.
]
"""What the compensator is doing, so that an app can tell its user what to do."""

EventKind = typing.Literal[
    "DeviceStep",  # The device's own disturbance changed (a magnet or cover was put on or taken off), and was relearned.
    "DeviceStepBack",  # The device is as it was before; that calibration was restored.
    "PlaceChanged",  # The field of the place changed; the calibration is held.
]
"""What changed."""

HeadingAid = typing.Literal[
    "used",  # They agree with the magnetometer, which knows north at least as well by itself.
    "leads",  # North is what they say, carried by the gyroscope: the magnetometer knows it less well.
    "disagrees",  # The latest one contradicts what is known, and is ignored.
]
"""What headings from outside are worth."""
