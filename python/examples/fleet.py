"""What a row costs: `fleet.py RECORDING...` reads and answers recordings one by one and all at once, and prints microseconds a row, the least of five
rounds, their ratio to pandas' reader, and the hours of recordings that make a minute; then the bytes of all answers. A round does each work once, so
that what else runs slows all of them. VQF, an orientation filter in C++, is there to compare. Needs `pip install pandas pyarrow vqf`, and recordings
whose sensors share their rows.
"""

import sys
import time
import warnings

import numpy as np
import pandas
import pyarrow
import vqf

import magcomp

ROUNDS = 5


def orientations(session):
    period_s = np.median(np.diff(session["time_ns"])) * 1e-9
    rows = (session["rotation_rate"][1], session["up"][1], session["field_ut"])
    return vqf.VQF(period_s).updateBatch(*(np.ascontiguousarray(values) for values in rows))


def main(paths):
    warnings.simplefilter("ignore")
    sessions = [magcomp.read_session(path) for path in paths]
    rows = sum(len(session["time_ns"]) for session in sessions)
    hours = sum(int(session["time_ns"][-1] - session["time_ns"][0]) for session in sessions) / 3.6e12
    works = {
        "pandas.read_csv": lambda: [pandas.read_csv(path, comment="#") for path in paths],
        "read_session": lambda: [magcomp.read_session(path) for path in paths],
        "vqf.VQF.updateBatch": lambda: [orientations(session) for session in sessions],
        "process": lambda: [magcomp.Compensator().process(**session) for session in sessions],
        "process_many, 1 worker": lambda: magcomp.process_many(paths, workers=1, progress=False),
        "process_many, 2 workers": lambda: magcomp.process_many(paths, workers=2, progress=False),
    }
    least_s = dict.fromkeys(works, np.inf)
    for _ in range(ROUNDS):
        for name, work in works.items():
            begun = time.perf_counter()
            work()
            least_s[name] = min(least_s[name], time.perf_counter() - begun)
    print(f"{len(paths)} recordings, {rows} rows, {hours:.3f} hours")
    for name, taken_s in least_s.items():
        ratio = taken_s / least_s["pandas.read_csv"]
        print(f"{name:24} {1e6 * taken_s / rows:6.2f} us a row, {ratio:5.2f} times pandas' reader, {60 * hours / taken_s:5.1f} hours a minute")
    many = magcomp.process_many(paths, progress=False)
    print(f"process_many keeps {pyarrow.table(many).nbytes / len(many):.0f} bytes a row")


if __name__ == "__main__":
    main(sys.argv[1:])
