"""What a row costs: `fleet.py RECORDING...` reads and answers recordings one by one and all at once, and prints microseconds a row, the least of five
rounds each."""

import sys
import time
import warnings

import pandas

import magcomp

ROUNDS = 5


def least(work):
    times = []
    for _ in range(ROUNDS):
        begun = time.perf_counter()
        work()
        times.append(time.perf_counter() - begun)
    return min(times)


def main(paths):
    warnings.simplefilter("ignore")
    sessions = [magcomp.read_session(path) for path in paths]
    rows = sum(len(session["time_ns"]) for session in sessions)
    works = {
        "pandas.read_csv": lambda: [pandas.read_csv(path, comment="#") for path in paths],
        "read_session": lambda: [magcomp.read_session(path) for path in paths],
        "process": lambda: [magcomp.Compensator().process(**session) for session in sessions],
        "process_many, 1 worker": lambda: magcomp.process_many(paths, workers=1, progress=False),
        "process_many, 2 workers": lambda: magcomp.process_many(paths, workers=2, progress=False),
    }
    print(f"{len(paths)} recordings, {rows} rows")
    for name, work in works.items():
        print(f"{name:24} {1e6 * least(work) / rows:6.2f} us a row")


if __name__ == "__main__":
    main(sys.argv[1:])
