"""The code of docs/FLEETS.md runs, on recordings, tables and bags that other people's libraries wrote; what is no bag that can be read says so."""

import contextlib
import importlib.util
import re
import shutil
from pathlib import Path

import numpy as np
import pandas
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

import magcomp

from conftest import ROOT
from test_many import ENGINES

ROS = get_typestore(Stores.ROS2_JAZZY)
START_NS = 1_700_000_000_000_000_000


def write_bag(path, table, plugin=StoragePlugin.MCAP, mode=CompressionMode.NONE):
    """A table as `ros2 bag record` has it: tesla, the axes of a robot, x forward and y left."""

    def message(kind, time_ns, **fields):
        stamp = ROS.types["builtin_interfaces/msg/Time"](sec=time_ns // 10**9, nanosec=time_ns % 10**9)
        return ROS.types[kind](header=ROS.types["std_msgs/msg/Header"](stamp=stamp, frame_id="imu"), **fields)

    def robot(x, y, z):
        return ROS.types["geometry_msgs/msg/Vector3"](x=float(y), y=float(-x), z=float(z))

    nothing, level = np.zeros(9), ROS.types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0)
    writer = Writer(path, version=9, storage_plugin=plugin)
    if mode is not CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        kinds = ["sensor_msgs/msg/MagneticField", "sensor_msgs/msg/Imu"]
        topics = [writer.add_connection(f"/{k}", kind, typestore=ROS) for k, kind in enumerate(kinds)]
        for t_s, mx, my, mz, *rate_up in table[["t_s", "mx", "my", "mz", "gx", "gy", "gz", "ax", "ay", "az"]].to_numpy():
            time_ns = START_NS + round(t_s * 1e9)
            field = message(kinds[0], time_ns, magnetic_field=robot(mx / 1e6, my / 1e6, mz / 1e6), magnetic_field_covariance=nothing)
            imu = message(
                kinds[1],
                time_ns,
                orientation=level,
                orientation_covariance=nothing,
                angular_velocity=robot(*rate_up[:3]),
                angular_velocity_covariance=nothing,
                linear_acceleration=robot(*rate_up[3:]),
                linear_acceleration_covariance=nothing,
            )
            for topic, kind, one in zip(topics, kinds, (field, imu)):
                writer.write(topic, time_ns, ROS.serialize_cdr(one, kind))


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    return ENGINES["generate"](tmp_path_factory.mktemp("fleet"), 3, seconds=12)


def test_the_pages_code_runs(paths, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs/FLEETS.md").read_text()
    frame = pandas.read_csv(paths[0])
    frame.to_csv("walk.csv", index=False)
    (tmp_path / "bags").mkdir()
    for path in paths:
        write_bag(tmp_path / "bags" / f"{Path(path).stem}", pandas.read_csv(path))
    names = {"paths": paths, "frame": frame}
    with contextlib.ExitStack() as stack:
        for block in re.findall(r"```python\n(.*?)```", page, re.S):
            if "magcomp.spark" in block:
                if importlib.util.find_spec("pyspark") is None:
                    continue
                names["spark"] = ENGINES["spark_session"]()
                stack.callback(names["spark"].stop)
            exec(block, names)
    expected = magcomp.process_many(paths, progress=False).to_pandas().set_index("recording")
    walk = expected.loc[paths[0]].reset_index(drop=True)

    # polars and xarray: the same recording as two kinds of table, and their answers
    tables = names["tables"].to_pandas()
    for name in ("polars", "xarray"):
        pandas.testing.assert_frame_equal(tables[tables.recording == name].drop(columns="recording").reset_index(drop=True), walk)
    assert set(names["sigma_deg"]["recording"]) == {"polars", "xarray"} and names["sigma_deg"]["heading_sigma_deg"].max() < 10
    np.testing.assert_array_equal(names["answers"]["xarray"]["heading_deg"].values, walk["heading_deg"])
    np.testing.assert_array_equal(names["answers"]["xarray"]["time_ns"].values, walk["time_ns"])

    # bags, whose axes are a robot's
    bags, forward_deg = names["bags"].to_pandas(), names["forward_deg"].to_numpy()
    assert not names["bags"].errors and len(bags) == len(expected)
    for robot, sign, phone in [("x", 1, "y"), ("y", -1, "x"), ("z", 1, "z")]:
        np.testing.assert_allclose(bags[f"field_{robot}_ut"], sign * expected[f"field_{phone}_ut"], atol=1e-3)
    up = np.concatenate([pandas.read_csv(path)[["ax", "ay", "az"]] for path in paths])
    level = (up[:, 2] > 0.99 * np.linalg.norm(up, axis=1)) & np.isfinite(forward_deg)
    off_deg = (forward_deg - expected["heading_deg"].to_numpy() + 180) % 360 - 180
    assert level.sum() > 10 and np.abs(off_deg[level]).max() < 3, (level.sum(), np.abs(off_deg[level]).max())


def test_bags_that_are_not_read_say_what_to_do(paths, tmp_path):
    table = pandas.read_csv(paths[0]).head(100)
    kinds = {
        "sqlite": (StoragePlugin.SQLITE3, CompressionMode.NONE, "`ros2 bag convert` makes an mcap file of it"),
        "file": (StoragePlugin.MCAP, CompressionMode.FILE, "zstd -d"),
        "message": (StoragePlugin.MCAP, CompressionMode.MESSAGE, "`ros2 bag convert` unpacks them"),
        "storage": (StoragePlugin.MCAP, CompressionMode.STORAGE, None),
    }
    expected = {}
    for name, (plugin, mode, why) in kinds.items():
        write_bag(tmp_path / name, table, plugin, mode)
        expected[str(tmp_path / name)] = why
    # two bags in one folder, a folder of folders, and a bag's own description alone
    loose, empty = tmp_path / "loose", tmp_path / "empty"
    loose.mkdir(), empty.mkdir()
    for name in ("a", "b"):
        shutil.copy(tmp_path / "storage/storage.mcap", loose / f"{name}.mcap")
    shutil.copy(tmp_path / "storage/metadata.yaml", empty)
    expected |= {str(loose): "bags of their own", str(tmp_path): "give each recording's own folder", str(empty): "no file there ends in"}
    expected[str(ROOT / "rust/magcomp-recordings/tests/sessions/ros2_two_topics.mcap")] = "name one by --topics"
    many = magcomp.process_many(list(expected), progress=False)
    assert many.recordings == [path for path, why in expected.items() if why is None] and len(many) == 100
    for path, why in expected.items():
        assert why is None or why in many.errors[path], many.errors[path]
    with pytest.raises(magcomp.MagcompError, match="iterdir"):
        magcomp.process_many(str(tmp_path))
