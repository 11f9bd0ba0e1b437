"""Headings: facts written by hand, and attitudes computed in the world frame.

World frame: east, north, up, north magnetic. The formula: turn the device's axis into the world by the attitude matrix R
(device to world) and read its compass bearing, atan2(east, north). The code under test sees field and up in the device
frame, R^T (0, F cos dip, -F sin dip) and R^T (0, 0, 1), and never R.

Attitude: yaw (clockwise seen from above), then pitch (top edge up), then roll (right edge down):
R = Rz(-yaw) Rx(pitch) Ry(roll). Its quaternion w, x, y, z is multiplied from half angles, so that it comes from no matrix.

Automatic axis (documented in heading.rs): the level direction square to the screen's right edge, up x right; where the
right edge rises beyond a sine of 0.707 the camera takes over in proportion, alone from 0.9.
"""

import numpy as np
from common import write

SEED = 20240603
HORIZONTAL, DOWN = 20.0, 40.0
# the field of the facts points 63.4 deg down: atan(40 / 20)
FACT_DIP = 63.43494882292201

# (name, screen rotation, field in the device frame, up in the device frame, heading of: top edge, camera, automatic)
# The field is 20 uT to the north and 40 uT down. Worked out on paper: flat with the top edge east, the right edge
# points south, so x reads -20; and so on.
FACTS = [
    ("flat, top edge north", 0, [0, 20, -40], [0, 0, 1], 0, None, 0),
    ("flat, top edge east", 0, [-20, 0, -40], [0, 0, 1], 90, None, 90),
    ("flat, top edge south", 0, [0, -20, -40], [0, 0, 1], 180, None, 180),
    ("flat, top edge west", 0, [20, 0, -40], [0, 0, 1], 270, None, 270),
    ("upright, camera north", 0, [0, -40, -20], [0, 1, 0], None, 0, 0),
    ("upright, camera east", 0, [-20, -40, 0], [0, 1, 0], None, 90, 90),
    ("upright, camera south", 0, [0, -40, 20], [0, 1, 0], None, 180, 180),
    ("upright, camera west", 0, [20, -40, 0], [0, 1, 0], None, 270, 270),
    # screen down, as held overhead: the automatic heading is that of the person under it
    ("face down, top edge north", 0, [0, 20, 40], [0, 0, -1], 0, None, 180),
    ("face down, top edge east", 0, [20, 0, 40], [0, 0, -1], 90, None, 270),
    ("face down, top edge south", 0, [0, -20, 40], [0, 0, -1], 180, None, 0),
    ("face down, top edge west", 0, [-20, 0, 40], [0, 0, -1], 270, None, 90),
    # flat, the device's own top edge north, its content turned
    ("flat, content turned 90", 90, [0, 20, -40], [0, 0, 1], 90, None, 90),
    ("flat, content turned 180", 180, [0, 20, -40], [0, 0, 1], 180, None, 180),
    ("flat, content turned 270", 270, [0, 20, -40], [0, 0, 1], 270, None, 270),
    # upright landscape: the device turned counter-clockwise (right edge up), then clockwise (left edge up)
    ("upright landscape 90, camera north", 90, [-40, 0, -20], [1, 0, 0], None, 0, 0),
    ("upright landscape 90, camera east", 90, [-40, 20, 0], [1, 0, 0], None, 90, 90),
    ("upright landscape 270, camera north", 270, [40, 0, -20], [-1, 0, 0], None, 0, 0),
    ("upright landscape 270, camera west", 270, [40, 20, 0], [-1, 0, 0], None, 270, 270),
    ("upright landscape, screen locked, camera north", 0, [-40, 0, -20], [1, 0, 0], 270, 0, 0),
    ("upside down portrait 180, camera south", 180, [0, 40, 20], [0, -1, 0], None, 180, 180),
]
AXES = {
    0: ([1, 0, 0], [0, 1, 0]),
    90: ([0, -1, 0], [1, 0, 0]),
    180: ([-1, 0, 0], [0, -1, 0]),
    270: ([0, 1, 0], [-1, 0, 0]),
}


def turn(axis, deg):
    c, s = np.cos(np.radians(deg)), np.sin(np.radians(deg))
    return {
        "x": np.array([[1, 0, 0], [0, c, -s], [0, s, c]]),
        "y": np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]),
        "z": np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
    }[axis]


def half(axis, deg):
    """The turn as a quaternion w, x, y, z."""
    q = np.zeros(4)
    q[0], q[1 + "xyz".index(axis)] = np.cos(np.radians(deg) / 2), np.sin(np.radians(deg) / 2)
    return q


def product(p, q):
    """Hamilton's: first q, then p."""
    w, v = p[0] * q[0] - p[1:] @ q[1:], p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])
    return np.array([w, *v])


def bearing(v):
    """None within 1e-3 of the vertical: no bearing that a test could hold anyone to."""
    return None if np.hypot(v[0], v[1]) < 1e-3 else float(np.degrees(np.arctan2(v[0], v[1])) % 360)


def automatic(right, camera):
    rise = abs(right[2])
    share = min(max((rise - 0.707) / (0.9 - 0.707), 0.0), 1.0)
    level = np.array([-right[1], right[0], 0.0])
    return (1 - share) * level / max(np.hypot(*right[:2]), 1e-12) + share * camera


def attitude(yaw, pitch, roll, dip, strength):
    r = turn("z", -yaw) @ turn("x", pitch) @ turn("y", roll)
    field = r.T @ (strength * np.array([0, np.cos(np.radians(dip)), -np.sin(np.radians(dip))]))
    # the same turns as half angles: no matrix
    q = product(product(half("z", -yaw), half("x", pitch)), half("y", roll))
    answers = {}
    for rotation, (right, top) in AXES.items():
        right, top, camera = r @ right, r @ top, r @ np.array([0, 0, -1])
        answers[str(rotation)] = {
            "top_edge_deg": bearing(top),
            "camera_deg": bearing(camera),
            "auto_deg": bearing(automatic(right, camera)),
        }
    return {
        "yaw_deg": yaw,
        "pitch_deg": pitch,
        "roll_deg": roll,
        "field_ut": field,
        "up": r.T @ [0, 0, 1],
        "inclination_deg": dip,
        "attitude": q if q[0] >= 0 else -q,
        "screen_rotations": answers,
    }


def main():
    rng = np.random.default_rng(SEED)
    facts = []
    for name, rotation, field, up, top, camera, auto in FACTS:
        facts.append(
            {
                "name": name,
                "screen_rotation_deg": rotation,
                "field_ut": [float(v) for v in field],
                "up": [float(v) for v in up],
                "inclination_deg": FACT_DIP,
                "top_edge_deg": top,
                "camera_deg": camera,
                "auto_deg": auto,
            }
        )
    attitudes = []
    for k in range(150):
        yaw, pitch, roll = rng.uniform(0, 360), rng.uniform(-180, 180), rng.uniform(-90, 90)
        dip = rng.uniform(-85, 85)
        if k % 5 == 4:  # near a pole: of the field, or of an axis
            dip = rng.choice([-1, 1]) * (90 - 10 ** rng.uniform(-1.5, 0.5))
        if k % 5 == 3:
            pitch, roll = rng.choice([-90, 90]) + rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5)
        attitudes.append(attitude(yaw, pitch, roll, dip, rng.uniform(22, 67)))
    about = "headings in degrees clockwise from magnetic north; null where the axis points up or down; attitude w x y z, device to east north up"
    write("headings.json", "headings.py", SEED, about, {"facts": facts, "attitudes": attitudes})


if __name__ == "__main__":
    main()
