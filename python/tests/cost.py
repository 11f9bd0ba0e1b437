"""`tests/instructions.sh borders`: `cost.py process|push METHOD COUNT < EVENTS` pushes the events of the first COUNT magnetometer samples, as arrays or
one by one. EVENTS, as c/examples/stream.c reads them, are read whatever COUNT is, so that reading them is not in the difference of two counts."""

import sys

import numpy as np

import magcomp

how, method, count = sys.argv[1], sys.argv[2], int(sys.argv[3])
rows = {"g": [], "a": [], "m": []}
for line in sys.stdin:
    sensor, time_ns, *values = line.split()
    rows[sensor].append((int(time_ns), np.array(values, dtype=float)))
rate, up, field = (
    (np.array([time_ns for time_ns, _ in rows[sensor]]), np.array([values for _, values in rows[sensor]])) for sensor in "gam"
)
compensator = magcomp.Compensator(method=method)
if how == "process":
    first = [(times[:count], values[:count]) for times, values in (rate, up, field)]
    answers = compensator.process(*first[2], rotation_rate=first[0], up=first[1])
    assert len(answers["heading_deg"]) == count and answers["left_out"] == 0
else:
    for turned, leans, sample in zip(rows["g"][:count], rows["a"][:count], rows["m"][:count], strict=True):
        compensator.push_rotation_rate(*turned)
        compensator.push_up(*leans)
        reading = compensator.push(*sample)
    assert reading.time_ns == rows["m"][count - 1][0]
