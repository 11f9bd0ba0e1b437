"""Many recordings at once: the same answers as one by one, errors by recording, Ctrl-C, results that are taken up again, engines."""

import os
import pickle
import re
import runpy
import shutil
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pandas
import polars
import pyarrow
import pytest

import magcomp

from conftest import ROOT
from test_borders import TIMES, turned

RECORDINGS = sorted((ROOT / "tests/recordings").glob("broad_*.csv.gz"))[:3]


def one_by_one(recordings):
    """What `process` answers for each, below one another."""
    frames = []
    for path in recordings:
        session = magcomp.read_session(path)
        frame = magcomp.to_frame(session["time_ns"], magcomp.Compensator().process(**session)).reset_index()
        frames.append(frame.assign(recording=str(path)))
    return pandas.concat(frames, ignore_index=True)


def same(found, expected):
    for name in ("recording", "status"):
        assert found[name].astype(str).tolist() == expected[name].tolist(), name
    for name in ("time_ns", "field_x_ut", "filtered_field_z_ut", "field_sigma_ut", "heading_deg", "heading_sigma_deg", "direction_sigma_deg"):
        np.testing.assert_array_equal(found[name].to_numpy(), expected[name].to_numpy(), name)


@pytest.fixture(scope="module")
def expected():
    return one_by_one(RECORDINGS)


@pytest.mark.filterwarnings("ignore")
def test_the_answers_are_those_of_process_and_an_error_ends_nothing(expected, tmp_path, capsys):
    broken = tmp_path / "broken.csv"
    broken.write_text("nothing of a sensor\n")
    many = magcomp.process_many([RECORDINGS[0], broken, *RECORDINGS[1:], "nowhere.csv"], workers=3)
    assert many.recordings == [str(path) for path in RECORDINGS] and len(many) == len(expected)
    assert list(many.errors) == [str(broken), "nowhere.csv"]
    assert "broken.csv" in many.errors[str(broken)] and "nowhere.csv" in many.errors["nowhere.csv"]
    assert set(many.warnings) == set(many.left_out) == set(many.events) == set(many.recordings)
    same(many.to_pandas(), expected)
    assert capsys.readouterr().err.endswith("5 of 5 recordings, 2 errors\n")


def test_arrow_and_polars_read_it(expected):
    many = magcomp.process_many(RECORDINGS, progress=False)
    table = pyarrow.table(many)
    same(table.to_pandas(), expected)
    same(polars.DataFrame(many).to_pandas(), expected)
    assert table["heading_deg"].null_count == expected["heading_deg"].isna().sum() > 0


def test_tables_are_taken_and_what_is_wrong_with_one_is_its_error():
    h = turned(2000)
    frame = pandas.DataFrame(h, columns=["mx", "my", "mz"]).assign(time_ns=TIMES)
    session = {"time_ns": TIMES, "field_ut": h, "rotation_rate": None, "up": None}
    tables = {"frame": frame, "session": session, "seconds": {**session, "time_ns": TIMES / 1e9}, "bare": frame.drop(columns="mz"), "no": 7}
    many = magcomp.process_many(tables, progress=False, method="Adaptive")
    assert many.recordings == ["frame", "session"] and list(many.errors) == ["seconds", "bare", "no"]
    assert "whole nanoseconds" in many.errors["seconds"] and "missing: mz" in many.errors["bare"] and "it is a int" in many.errors["no"]
    found = many.to_pandas()
    expected = magcomp.Compensator(method="Adaptive").process(TIMES, h)["field_ut"][:, 0]
    for name in many.recordings:
        np.testing.assert_array_equal(found.loc[found.recording == name, "field_x_ut"], expected)


def test_arrays_and_tables_of_any_kind_are_the_same_recording_or_say_why_not():
    h = turned(2000)
    rate, up = np.full((2000, 3), 0.1), np.full((2000, 3), [0.0, 0.0, 9.81])
    session = {"time_ns": TIMES, "field_ut": h, "rotation_rate": (TIMES, rate), "up": (TIMES, up)}
    names = [letter + axis for letter in "mga" for axis in "xyz"]
    frame = pandas.DataFrame(np.hstack([h, rate, up]), columns=names).assign(time_ns=TIMES)
    # gaps: rows in which a sensor says nothing, and rows in which none does
    gaps = pandas.concat([frame, pandas.DataFrame({"time_ns": TIMES[::10] + 1})]).sort_values("time_ns", ignore_index=True)
    masked = np.ma.masked_greater(h, h.max() - 1)
    part = frame.copy()
    part.loc[1000, "my"] = part.loc[1500, "gz"] = np.nan
    tables = {
        "session": session,
        "uint64": session | {"time_ns": TIMES.astype(np.uint64), "up": (TIMES.astype(np.uint64), up)},
        "strided": session | {"field_ut": np.repeat(h, 2, axis=1)[:, ::2], "rotation_rate": (np.repeat(TIMES, 2)[::2], np.asfortranarray(rate))},
        "backwards": session | {"up": (TIMES[::-1], up[::-1])},
        "nothing masked": session | {"field_ut": np.ma.asarray(h)},
        "pandas": gaps,
        "nullable": gaps.convert_dtypes(),
        "of arrow": gaps.convert_dtypes(dtype_backend="pyarrow"),
        "polars": polars.from_pandas(gaps),
        "arrow": pyarrow.Table.from_pandas(gaps),
        "part": part,
    }
    wrong = {
        "masked field": (session | {"field_ut": masked}, "field_ut has masked values; leave their rows out"),
        "masked turn": (session | {"rotation_rate": (TIMES, np.ma.masked_equal(rate, 0.1))}, "rotation_rate.* has masked values"),
        "masked times": (session | {"up": (np.ma.masked_equal(TIMES, 0), up)}, "up.* has masked values"),
        "far": (session | {"time_ns": TIMES.astype(np.uint64) + 2**63}, "beyond 2\\^63"),
        "no time": (polars.from_pandas(gaps).with_columns(time_ns=polars.lit(None, polars.Int64)), "time that is missing"),
        "words": (frame.astype({"mx": str}).assign(mx="north"), "north"),
    }
    many = magcomp.process_many(tables | {name: table for name, (table, _) in wrong.items()}, progress=False)
    assert list(many.errors) == list(wrong) and many.recordings == list(tables)
    for name, (_, why) in wrong.items():
        assert re.search(why, many.errors[name]), many.errors[name]
    found = {name: part.reset_index(drop=True) for name, part in many.to_pandas().groupby("recording", observed=True)}
    expected = found["session"].drop(columns="recording")
    for name in tables.keys() - {"part"}:
        pandas.testing.assert_frame_equal(found[name].drop(columns="recording"), expected, obj=name)
    # a row with a part of its values is a sample that is refused
    assert found["part"]["status"].eq("rejected").to_numpy().nonzero()[0].tolist() == [1000] and many.left_out["part"] == 1


def test_what_is_no_list_of_recordings_is_refused():
    for given, why in [("a.csv", "needs a list"), ({"time_ns": [], "field_ut": []}, "needs a list"), (["a.csv", "a.csv"], "twice")]:
        with pytest.raises(magcomp.MagcompError, match=why):
            magcomp.process_many(given)
    with pytest.raises(magcomp.MagcompError, match="workers is 0"):
        magcomp.process_many([], workers=0)
    with pytest.raises(magcomp.ConfigError, match="methode"):
        magcomp.process_many([], methode="Aided")


def test_a_folder_of_results_is_taken_up_again(expected, tmp_path):
    results = tmp_path / "results"
    own = tmp_path / "own.csv.gz"
    shutil.copy(RECORDINGS[1], own)
    paths = [RECORDINGS[0], own, tmp_path / "later.csv.gz"]
    first = magcomp.process_many(paths, results=results, progress=False)
    assert list(first.errors) == [str(paths[2])]
    written = {path.name: path.stat().st_mtime_ns for path in results.iterdir()}
    assert len(written) == 2 and all(name.endswith(".arrow") for name in written)
    # one is new, one is another file of the same name, one is taken as it is
    shutil.copy(RECORDINGS[2], paths[2])
    shutil.copy(RECORDINGS[2], own)
    second = magcomp.process_many(paths, results=results, progress=False)
    now = {path.name: path.stat().st_mtime_ns for path in results.iterdir()}
    assert not second.errors and len(now) == 3 and sum(now[name] == at for name, at in written.items()) == 1
    found = second.to_pandas()
    names = {str(RECORDINGS[0]): str(paths[0]), str(RECORDINGS[2]): str(own)}
    for source, name in names.items():
        part = expected[expected.recording == source]
        same(found[found.recording == name].assign(recording=source), part)
    # other settings are another run
    other = magcomp.process_many(paths[:1], results=results, progress=False, heading={"declination_deg": 3.0})
    assert other.to_pandas()["true_heading_deg"].notna().any()
    # a file that a run left half
    half = next(results.iterdir())
    half.write_bytes(half.read_bytes()[:1000])
    assert not magcomp.process_many(paths, results=results, progress=False).errors


@pytest.mark.skipif(os.name != "posix", reason="signals")
def test_ctrl_c_ends_it(tmp_path):
    """While recordings are answered that would take minutes."""
    program = f"""
import magcomp, numpy as np
field = np.random.default_rng(1).normal(size=(1_000_000, 3)) * 20 + 30
table = {{"time_ns": np.arange(len(field)) * 10_000_000, "field_ut": field, "rotation_rate": None, "up": None}}
print("begun", flush=True)
try:
    magcomp.process_many({{str(k): table for k in range(4)}}, progress=False)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
    process = subprocess.Popen([sys.executable, "-P", "-c", program], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "begun\n"
    time.sleep(1)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=60)
    assert out == "interrupted\n" and process.returncode == 0


def test_other_threads_run_meanwhile():
    ticks, ended = [], threading.Event()

    def tick():
        while not ended.wait(0.001):
            ticks.append(1)

    thread = threading.Thread(target=tick)
    thread.start()
    magcomp.process_many(RECORDINGS, progress=False)
    ended.set()
    thread.join()
    assert ticks


def test_a_compensator_is_pickled_with_what_it_has_learned():
    made = magcomp.Compensator(method="Adaptive", rail_ut=1200.0)
    h = turned(1000)
    for part in slice(500), slice(500, 1000):  # new, and after five seconds
        again = pickle.loads(pickle.dumps(made))
        assert again.config == made.config
        np.testing.assert_array_equal(again.process(TIMES[part], h[part])["field_ut"], made.process(TIMES[part], h[part])["field_ut"])
    assert pickle.dumps(again) == pickle.dumps(made)
    with pytest.raises(magcomp.MagcompError, match="no bytes of a pickled compensator"):
        magcomp._magcomp._compensator(magcomp.__version__, b"half")
    version = magcomp.__version__.encode()
    other = pickle.dumps(magcomp.Compensator()).replace(version, b"9" * len(version))
    with pytest.raises(magcomp.MagcompError, match="pickled by magcomp 9"):
        pickle.loads(other)


# The engines themselves, local clusters of them: a few generated recordings at each landing, a thousand at night
ENGINES = runpy.run_path(str(ROOT / "python/examples/engines.py"))
NIGHT = bool(os.environ.get("MAGCOMP_NIGHT"))


@pytest.fixture(scope="module")
def generated(tmp_path_factory):
    """Paths, of which every seventh is that of no recording, and what `process_many` answers."""
    folder = tmp_path_factory.mktemp("generated")
    paths = ENGINES["generate"](folder, 1000 if NIGHT else 12, seconds=12)
    for path in paths[3::7]:
        shutil.copy(__file__, path)
    many = magcomp.process_many([*paths, "nowhere.csv"], progress=False)
    assert set(many.errors) == {*paths[3::7], "nowhere.csv"} and len(many) == 600 * len(many.recordings)
    answers = many.to_pandas()
    assert (answers.groupby("recording", observed=True)["heading_deg"].count() > 300).all()
    return [*paths, "nowhere.csv"], many.errors, answers


def engine_rows(found, generated):
    _, errors, expected = generated
    failed = found["error"].notna()
    assert dict(zip(found.loc[failed, "recording"], found.loc[failed, "error"])) == errors and failed.sum() == len(errors)
    order = ["recording", "time_ns"]
    expected = expected.astype({"recording": str, "status": str}).sort_values(order)
    same(found[~failed].sort_values(order).astype({"time_ns": np.int64}), expected)


def test_spark_gives_the_same_rows(generated):
    pytest.importorskip("pyspark.sql")
    session = ENGINES["spark_session"]()
    try:
        engine_rows(ENGINES["on_spark"](generated[0], session).toPandas(), generated)
    finally:
        session.stop()


def test_dask_gives_the_same_rows(generated):
    with ENGINES["dask_client"]() as client:
        engine_rows(ENGINES["on_dask"](generated[0], client).compute(), generated)
