"""What an engine costs on this machine: `engines.py [COUNT...] [--seconds S]` writes so many recordings of a phone that is turned by hand, S seconds at
50 Hz each, answers them by `process_many`, by Dask and by Spark, each on two cores, and prints what each took and how many hours of recordings that is
a minute. What an engine takes to start is told apart. Needs `pip install "dask[dataframe,distributed]" pandas polars pyarrow pyspark`, and Java for Spark.
"""

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pandas
import polars

import magcomp

HZ = 50
CORES = 2
EARTH_UT = [0.0, 22.0, -42.0]  # east, north, up


def turn(angle):
    """The rotation matrices of rotation vectors, shape (n, 3)."""
    size = np.linalg.norm(angle, axis=1)[:, None, None]
    cross = np.zeros((len(angle), 3, 3))
    cross[:, [2, 0, 1], [1, 2, 0]] = angle
    cross[:, [1, 2, 0], [2, 0, 1]] = -angle
    return np.eye(3) + np.sinc(size / np.pi) * cross + 0.5 * np.sinc(size / (2 * np.pi)) ** 2 * (cross @ cross)


def generate(folder, count, seconds, seed=1):
    """Writes recordings into a folder, each with a hard iron of its own; in every other one it changes halfway, as by a cover. Returns the paths."""
    random = np.random.default_rng(seed)
    steps = seconds * HZ
    time_s = np.arange(steps) / HZ
    # a hand's turns about three axes, rad/s
    speed, frequency, phase = (random.uniform(*span, (count, 3)) for span in [(0.5, 2.0), (0.1, 0.5), (0.0, 2 * np.pi)])
    rate = speed[:, None] * np.sin(2 * np.pi * frequency[:, None] * time_s[:, None] + phase[:, None])
    field, up = np.empty((count, steps, 3)), np.empty((count, steps, 3))
    to_world = turn(random.normal(size=(count, 3)))
    for k in range(steps):
        field[:, k], up[:, k] = EARTH_UT @ to_world, [0, 0, 9.81] @ to_world
        to_world = to_world @ turn(rate[:, k] / HZ)
    field += random.normal(size=(count, 1, 3)) * 40 + random.normal(size=field.shape) * 0.4
    field[::2, steps // 2 :] += random.normal(size=(len(field[::2]), 1, 3)) * 20
    up += random.normal(size=up.shape) * 0.05
    rate += random.normal(size=(count, 1, 3)) * 0.005 + random.normal(size=rate.shape) * 0.005
    names = [letter + axis for letter in "mga" for axis in "xyz"]
    paths = []
    for number, values in enumerate(np.concatenate([field, rate, up], axis=2).round(4)):
        paths.append(str(Path(folder) / f"{number:04}.csv"))
        polars.DataFrame(values, schema=names).insert_column(0, polars.Series("t_s", time_s)).write_csv(paths[-1])
    return paths


def on_dask(paths, client):
    """The answers as a frame of Dask, whose tasks run where `client` says."""
    import dask.dataframe

    import magcomp.dask

    tasks = min(len(paths), 8 * CORES)
    return magcomp.dask.process_many(dask.dataframe.from_pandas(pandas.DataFrame({"recording": paths}), npartitions=tasks))


def dask_client():
    import distributed

    return distributed.Client(n_workers=CORES, threads_per_worker=1, dashboard_address=None)


def on_spark(paths, session):
    """The answers as a frame of Spark."""
    import magcomp.spark

    frame = session.createDataFrame([(path,) for path in paths], ["recording"])
    return magcomp.spark.process_many(frame.repartition(min(len(paths), 8 * CORES)))


def spark_session():
    from pyspark.sql import SparkSession

    os.environ["PYSPARK_PYTHON"] = sys.executable
    settings = {"spark.ui.enabled": "false", "spark.sql.execution.arrow.pyspark.enabled": "true", "spark.driver.host": "127.0.0.1"}
    return SparkSession.builder.master(f"local[{CORES}]").config(map=settings).getOrCreate()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("counts", nargs="*", type=int, default=[10, 100, 1000])
    parser.add_argument("--seconds", type=int, default=60)
    given = parser.parse_args()
    works = {
        "process_many, 1 worker": (lambda: None, lambda paths, _: len(magcomp.process_many(paths, workers=1, progress=False))),
        "process_many, 2 workers": (lambda: None, lambda paths, _: len(magcomp.process_many(paths, workers=CORES, progress=False))),
        "Dask, 2 workers": (dask_client, lambda paths, client: len(on_dask(paths, client))),
        "Spark, 2 cores": (spark_session, lambda paths, session: on_spark(paths, session).count()),
    }
    with tempfile.TemporaryDirectory() as folder:
        paths = generate(folder, max(given.counts), given.seconds)
        for name, (start, work) in works.items():
            begun = time.perf_counter()
            engine = start()
            work(paths[:1], engine)
            print(f"{name}: the first recording after {time.perf_counter() - begun:.1f} s", flush=True)
            for count in given.counts:
                begun = time.perf_counter()
                rows = work(paths[:count], engine)
                taken_s = time.perf_counter() - begun
                assert rows == count * given.seconds * HZ, (name, count, rows)
                hours = count * given.seconds / 3600
                print(f"{name}: {count} recordings, {taken_s:.2f} s, {hours / (taken_s / 60):.1f} hours a minute", flush=True)
            if engine is not None:
                engine.stop() if name.startswith("Spark") else engine.close()


if __name__ == "__main__":
    main()
