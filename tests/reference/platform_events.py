"""What Android's and iOS's sensors report in known attitudes, and what a source of events must make of it.

World frame: east, north, up, north magnetic; field 30 uT north and 40 uT down. Attitudes by hand: a phone turned
counter-clockwise seen from above at 0.5 rad/s, every number worked out on paper. General attitudes: R (device to world) of
`headings.py`, the sensors' values R^T v of vectors v of the world, the heading the compass bearing of the device's axis in the
world; the phone turns about an axis that is neither up nor one of its own.

Conventions, from the platforms' documentation: both have x to the right of the screen, y to its top, z out of it, field in
microtesla, rotation rate in rad/s by the right-hand rule. Android's gravity points up in m/s^2, iOS's down in g.
"""

import numpy as np
from common import write
from headings import bearing, turn

SEED = 20261122
G = 9.80665
FIELD_UT = np.array([0.0, 30.0, -40.0])
DIP_DEG = float(np.degrees(np.arctan2(40, 30)))
RATE_RAD_S = np.array([0.5, -0.9, 1.3])
DEVICE_AXES = {"top_edge": [0, 1, 0], "camera": [0, 0, -1]}
# of each vector's components in a general attitude, as a share of its length: a flipped or exchanged axis shows
LEAST_SHARE = 0.25

# (name, axis, field, up, heading). Flat with the top edge east, for instance, the right edge points south, so x reads -30.
BY_HAND = [
    ("flat, top edge north", "top_edge", [0, 30, -40], [0, 0, 1], 0),
    ("flat, top edge east", "top_edge", [-30, 0, -40], [0, 0, 1], 90),
    ("flat, top edge south", "top_edge", [0, -30, -40], [0, 0, 1], 180),
    ("flat, top edge west", "top_edge", [30, 0, -40], [0, 0, 1], 270),
    ("upright, camera north", "camera", [0, -40, -30], [0, 1, 0], 0),
    ("upright, camera east", "camera", [-30, -40, 0], [0, 1, 0], 90),
    ("upright, camera south", "camera", [0, -40, 30], [0, 1, 0], 180),
    ("upright, camera west", "camera", [30, -40, 0], [0, 1, 0], 270),
    ("face down, top edge north", "top_edge", [0, 30, 40], [0, 0, -1], 0),
    ("face down, top edge east", "top_edge", [30, 0, 40], [0, 0, -1], 90),
    ("face down, top edge south", "top_edge", [0, -30, 40], [0, 0, -1], 180),
    ("face down, top edge west", "top_edge", [-30, 0, 40], [0, 0, -1], 270),
    # the right edge points up, so does x
    ("on its left side, camera north", "camera", [-40, 0, -30], [1, 0, 0], 0),
    ("on its left side, camera east", "camera", [-40, 30, 0], [1, 0, 0], 90),
    ("on its left side, camera south", "camera", [-40, 0, 30], [1, 0, 0], 180),
    ("on its left side, camera west", "camera", [-40, -30, 0], [1, 0, 0], 270),
    ("on its left side, top edge north", "top_edge", [-40, 30, 0], [1, 0, 0], 0),
    # the right edge points down
    ("on its right side, camera north", "camera", [40, 0, -30], [-1, 0, 0], 0),
    ("on its right side, camera east", "camera", [40, -30, 0], [-1, 0, 0], 90),
    ("on its right side, camera south", "camera", [40, 0, 30], [-1, 0, 0], 180),
    ("on its right side, camera west", "camera", [40, 30, 0], [-1, 0, 0], 270),
    ("on its right side, top edge north", "top_edge", [40, 30, 0], [-1, 0, 0], 0),
    ("upside down, camera north", "camera", [0, 40, -30], [0, -1, 0], 0),
    ("upside down, camera east", "camera", [30, 40, 0], [0, -1, 0], 90),
    ("upside down, camera south", "camera", [0, 40, 30], [0, -1, 0], 180),
    ("upside down, camera west", "camera", [-30, 40, 0], [0, -1, 0], 270),
]


def case(name, axis, field, up, rate, heading_deg):
    field, up, rate = (np.array(v, dtype=float) + 0.0 for v in (field, up, rate))
    return {
        "name": name,
        "axis": axis,
        "android": {"magnetic_field_uncalibrated": field, "gravity": up * G, "gyroscope": rate},
        "ios": {"magnetic_field": field, "gravity": 0.0 - up, "rotation_rate": rate},
        "field_ut": field,
        "up_m_s2": up * G,
        "rate_rad_s": rate,
        "heading_deg": heading_deg,
    }


def general(rng, name, axis):
    """An attitude at random in which no component of field, up and rotation rate is small."""
    while True:
        yaw, pitch, roll = rng.uniform(0, 360), rng.uniform(-180, 180), rng.uniform(-90, 90)
        r = turn("z", -yaw) @ turn("x", pitch) @ turn("y", roll)
        field, up, rate = r.T @ FIELD_UT, r.T @ [0, 0, 1], r.T @ RATE_RAD_S
        if all(np.abs(v).min() > LEAST_SHARE * np.linalg.norm(v) for v in (field, up, rate)):
            return case(name, axis, field, up, rate, bearing(r @ DEVICE_AXES[axis]))


def main():
    rng = np.random.default_rng(SEED)
    cases = [case(name, axis, field, up, np.multiply(up, 0.5), deg) for name, axis, field, up, deg in BY_HAND]
    cases += [general(rng, f"general {k + 1}", list(DEVICE_AXES)[k % 2]) for k in range(24)]
    about = (
        "A phone in attitudes worked out by hand, then in general ones: what Android's and iOS's sensors report there "
        "(microtesla; gravity in m/s^2 pointing up, and in g pointing down; rad/s), and what a source must make of it"
    )
    head = {"time_ns": 1500000000, "ios_timestamp_s": 1.5, "inclination_deg": DIP_DEG}
    write("platform_events.json", "platform_events.py", SEED, about, {**head, "cases": cases})


if __name__ == "__main__":
    main()
