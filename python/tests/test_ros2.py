"""The ROS 2 node of ros2/: a bag that `rosbags` wrote is played to it message by message; what it publishes is what the compensator says of the recording."""

import dataclasses
import importlib
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree

import numpy as np
import pandas
import pytest
import yaml
from rosbags.highlevel import AnyReader

import magcomp

import ros
from conftest import ROOT
from test_fleets import START_NS, write_bag

RECORDING = ROOT / "tests/recordings/broad_34_attached_magnet_3cm.csv.gz"
ROWS = 6000
TOPICS = {"/0": "imu/mag", "/1": "imu/data"}
IMU, MAG = "/1", "/0"


@pytest.fixture(scope="module")
def played(tmp_path_factory):
    """The bag's messages, as (topic, time, message) in the order in which they were recorded."""
    bag = tmp_path_factory.mktemp("bag") / "walk"
    write_bag(bag, pandas.read_csv(RECORDING, nrows=ROWS))
    with AnyReader([bag], default_typestore=ros.STORE) as reader:
        return [(one.topic, time_ns, ros.STORE.deserialize_cdr(raw, one.msgtype)) for one, time_ns, raw in reader.messages()]


@pytest.fixture(scope="module")
def expected():
    session = magcomp.from_frame(pandas.read_csv(RECORDING, nrows=ROWS))
    compensator = magcomp.Compensator()
    return session, compensator.process(**session), compensator.calibration


@pytest.fixture
def make(monkeypatch):
    def made(with_azimuth=True, **given):
        ros.install(monkeypatch, with_azimuth)
        monkeypatch.syspath_prepend(str(ROOT / "ros2"))
        for name in [name for name in sys.modules if name.startswith("magcomp_ros")]:
            monkeypatch.delitem(sys.modules, name)
        monkeypatch.setattr(ros.Node, "given", given)
        return importlib.import_module("magcomp_ros.node").Compass()

    return made


def play(node, messages):
    for topic, _, message in messages:
        node.callbacks[TOPICS[topic]](message)
    return node


def stamps(messages):
    return [it.header.stamp.sec * 10**9 + it.header.stamp.nanosec - START_NS for it in messages]


def azimuths(node, topic="compass/mag/enu/rad"):
    return {at: (it.azimuth, it.variance) for at, it in zip(stamps(node.told(topic)), node.told(topic))}


def test_a_bag_is_answered_as_the_recording_is(make, played, expected):
    session, answers, calibration = expected
    node = play(make(), played)
    known = np.isfinite(answers["heading_deg"]) & np.isfinite(answers["heading_sigma_deg"])
    found = azimuths(node)
    # the last sample waits for what comes after it
    assert known.sum() > 1000 and known.sum() - 1 <= len(found) <= known.sum()
    wanted = dict(zip(np.round((session["time_ns"] - session["time_ns"][0]) / 1e3).astype(int), zip(answers["heading_deg"], answers["heading_sigma_deg"])))
    first = min(stamps(node.told("imu/mag_unbiased")))
    begin = session["time_ns"][np.isfinite(answers["field_ut"][:, 0])][0] - session["time_ns"][0]
    for at, (azimuth, variance) in found.items():
        heading_deg, sigma_deg = wanted[round((at - first + begin) / 1e3)]
        off = (90 - math.degrees(azimuth) - heading_deg + 180) % 360 - 180
        assert abs(off) < 1e-3 and abs(math.degrees(math.sqrt(variance)) - sigma_deg) < 1e-3

    # the field without bias is the pipeline's of the bias: M^-1 (h_m - b)
    bias = node.told("imu/mag_bias")[-1]
    vector = lambda it: np.array([it.x, it.y, it.z])
    scale = bias.magnetic_field_covariance.reshape(3, 3)
    raw = [it for topic, _, it in played if topic == MAG]
    unbiased = node.told("imu/mag_unbiased")
    last_bias = stamps([bias])[0]
    near = [it for it in unbiased if 0 <= stamps([it])[0] - last_bias < 5e8]
    assert near
    for it in near:
        (sample,) = [sample for sample in raw if sample.header.stamp == it.header.stamp]
        by_pipeline = scale @ (vector(sample.magnetic_field) - vector(bias.magnetic_field))
        # but for the delay and the magnetometer's misalignment, of which the field is freed
        np.testing.assert_allclose(vector(it.magnetic_field), by_pipeline, atol=4e-6)
    b = vector(bias.magnetic_field) * 1e6
    np.testing.assert_allclose([-b[1], b[0], b[2]], calibration.hard_iron_ut, atol=1.0)
    assert unbiased[-1].magnetic_field_covariance[0] == unbiased[-1].magnetic_field_covariance[8] > 0


def test_diagnostics_say_what_the_status_says(make, played, expected):
    node = play(make(), played)
    told = node.told("diagnostics")
    assert len(told) == pytest.approx(played[-1][1] / 1e9 - played[0][1] / 1e9, abs=2)
    levels = {it.status[0].level for it in told}
    assert told[0].status[0].level == 1 and told[0].status[0].message.startswith("collecting: ") and 0 in levels
    values = {it.key: it.value for it in told[-1].status[0].values}
    assert values["imu_messages_left_out"] == "0" and 0 <= float(values["heading_deg"]) < 360


def test_the_order_in_which_topics_arrive_changes_nothing(make, played):
    part = played[:8000]
    want = azimuths(play(make(), part))
    assert len(want) > 500
    # all of a topic 30 ms late
    for late in (IMU, MAG):
        moved = sorted(part, key=lambda it: it[1] + (30_000_000 if it[0] == late else 0))
        found = azimuths(play(make(), moved))
        same = found.keys() & want.keys()
        assert len(same) > len(want) - 10 and all(found[at] == want[at] for at in same)


def test_without_an_imu_the_field_is_still_answered(make, played):
    field_alone = [it for it in played if it[0] == MAG]
    node = play(make(), field_alone)
    assert not node.told("compass/mag/enu/rad")
    assert node.told("imu/mag_bias") and len(node.told("imu/mag_unbiased")) > 1000


def test_an_imu_message_that_comes_too_late_is_counted(make, played):
    (index, late), *_ = [(k, it) for k, it in enumerate(played) if it[0] == IMU and k > 1000]
    node = play(make(), played[:index] + played[index + 1 : index + 2000] + [late] + played[index + 2000 : index + 3000])
    values = {it.key: it.value for it in node.told("diagnostics")[-1].status[0].values}
    assert values["imu_messages_left_out"] == "1"


def test_half_of_an_imu_message_that_cannot_be_used_leaves_the_other_half(make, played):
    def without_rate(topic, message):
        if topic == IMU:
            message = dataclasses.replace(message, angular_velocity=dataclasses.replace(message.angular_velocity, x=math.nan))
        return message

    node = play(make(), [(topic, at, without_rate(topic, message)) for topic, at, message in played])
    # no gyroscope, but gravity: a heading comes later, and comes
    assert len(azimuths(node)) > 500
    values = {it.key: it.value for it in node.told("diagnostics")[-1].status[0].values}
    # but those since the second began
    assert int(values["imu_messages_left_out"]) > ROWS - 60


def test_a_declination_makes_the_azimuth_the_true_one(make, played):
    part = played[:8000]
    magnetic, true = azimuths(play(make(), part)), play(make(declination_deg=10.0), part)
    found = azimuths(true, "compass/true/enu/rad")
    assert found.keys() == magnetic.keys() and len(found) > 100
    assert {it.reference for it in true.told("compass/true/enu/rad")} == {1}
    for at, (azimuth, _) in found.items():
        off = math.degrees(magnetic[at][0] - azimuth) % 360
        assert abs(off - 10) < 1e-9


def test_what_was_learned_is_kept_and_taken_over(make, played, tmp_path):
    file = tmp_path / "kept.json"
    node = play(make(calibration_file=str(file)), played)
    node.keep()
    assert '"magcomp_calibration":1' in file.read_text() and list(tmp_path.iterdir()) == [file]
    second = play(make(calibration_file=str(file)), played[:200])
    assert second.told("imu/mag_bias") and not second.said
    # a node that learned nothing leaves it
    before = file.read_text()
    make(calibration_file=str(file)).keep()
    assert file.read_text() == before
    for damage in (b"{", b"\xff\xfe"):
        file.write_bytes(damage)
        third = play(make(calibration_file=str(file)), played[:200])
        assert len(third.said) == 1 and str(file) in third.said[0] and third.told("diagnostics")
    nowhere = play(make(calibration_file=str(tmp_path / "none" / "kept.json")), played)
    nowhere.keep()
    assert len(nowhere.said) == 1 and "not kept" in nowhere.said[0]


def test_without_compass_interfaces_all_else_is_there(make, played):
    node = play(make(with_azimuth=False), played[:2000])
    assert len(node.said) == 1 and "compass_interfaces" in node.said[0]
    assert node.told("diagnostics") and not any(topic.startswith("compass/") for topic in node.publishers_)


def test_launch_and_parameter_file_name_what_there_is(make):
    parameters = yaml.safe_load((ROOT / "ros2/config/compass.yaml").read_text())["magcomp"]["ros__parameters"]
    node = make(**parameters)
    assert node.declared.keys() == parameters.keys()
    usual = make().declared
    assert all(str(usual[name]) == str(value) for name, value in parameters.items())
    launch = xml.etree.ElementTree.parse(ROOT / "ros2/launch/compass.launch.xml").getroot().find("node")
    assert launch.get("name") == "magcomp" and launch.get("pkg") == "magcomp_ros"
    setup = (ROOT / "ros2/setup.py").read_text()
    assert f'"{launch.get("exec")} = magcomp_ros.node:main"' in setup
    topics = set(node.callbacks) | set(node.publishers_)
    assert {it.get("from") for it in launch.findall("remap")} == {topic for topic in topics if topic.startswith("imu/")}
    page = (ROOT / "ros2/README.md").read_text()
    assert all(f"`{topic}`" in page for topic in topics) and all(f"`{name}`" in page for name in parameters)
    assert re.findall(r'version="?(?:>)?([0-9.]+)', setup) == [magcomp.__version__]


def test_colcon_builds_what_ros2_launch_looks_for(tmp_path):
    shutil.copytree(ROOT / "ros2", tmp_path / "src/magcomp_ros")
    folder = pathlib.Path(sys.executable).parent
    environment = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}", "COLCON_HOME": str(tmp_path)}
    subprocess.run([folder / "colcon", "build"], cwd=tmp_path, env=environment, check=True, timeout=300)
    installed = tmp_path / "install/magcomp_ros"
    assert os.access(installed / "lib/magcomp_ros/compass", os.X_OK)
    for file in ("launch/compass.launch.xml", "config/compass.yaml", "package.xml"):
        assert (installed / "share/magcomp_ros" / file).read_bytes() == (ROOT / "ros2" / file).read_bytes()
