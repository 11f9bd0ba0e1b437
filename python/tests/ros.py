"""Stand-ins for ROS 2's Python packages, none of which a registry of Python's has: as much of `rclpy` as ros2/ calls, and messages whose definitions are
those of `rosbags`. They are as strict as ROS 2's: no field that is not there, no integer for a float. What is published is written and read as it goes
over the wire (CDR)."""

import sys
import types

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

STORE = get_typestore(Stores.ROS2_JAZZY)
# the fields of compass_interfaces/msg/Azimuth.msg of the Czech Technical University in Prague (BSD-3-Clause)
AZIMUTH = """std_msgs/Header header
float64 azimuth
float64 variance
uint8 UNIT_RAD=0
uint8 UNIT_DEG=1
uint8 unit
uint8 ORIENTATION_ENU=0
uint8 ORIENTATION_NED=1
uint8 orientation
uint8 REFERENCE_MAGNETIC=0
uint8 REFERENCE_GEOGRAPHIC=1
uint8 REFERENCE_UTM=2
uint8 reference
"""
STORE.register(get_types_from_msg(AZIMUTH, "compass_interfaces/msg/Azimuth"))


def is_byte(kind):
    return kind in ("byte", "octet")


def blank(node, argument):
    if node == Nodetype.BASE:
        kind = argument[0]
        return "" if kind == "string" else b"\0" if is_byte(kind) else 0.0 if kind.startswith("float") else 0
    if node == Nodetype.NAME:
        return message(argument)()
    return np.zeros(argument[1]) if node == Nodetype.ARRAY else []


def check(name, node, argument, value):
    if node == Nodetype.BASE:
        kind = argument[0]
        want = str if kind == "string" else bytes if is_byte(kind) else float if kind.startswith("float") else int
        assert isinstance(value, want), f"{name} is {value!r}"
    elif node == Nodetype.NAME:
        assert value.__msgtype__ == argument, f"{name} is {value!r}"
    elif node == Nodetype.ARRAY:
        assert len(value) == argument[1] and np.asarray(value).dtype == np.float64, f"{name} is {value!r}"


def message(kind):
    """The class of a message: made without arguments it is all zeros."""
    constants, fields = STORE.fielddefs[kind]
    kinds = dict(fields)

    class Message:
        __slots__ = tuple(kinds)
        __msgtype__ = kind

        def __init__(self, **given):
            for name, (node, argument) in kinds.items():
                setattr(self, name, given.pop(name) if name in given else blank(node, argument))
            assert not given, given

        def __setattr__(self, name, value):
            check(name, *kinds[name], value)
            object.__setattr__(self, name, value)

    for name, type_of, value in constants:
        setattr(Message, name, bytes([value]) if is_byte(type_of) else value)
    return Message


def of_store(value):
    """The same message, of the class that `rosbags` writes."""
    if isinstance(value, list):
        return [of_store(one) for one in value]
    if not hasattr(value, "__slots__") or not hasattr(value, "__msgtype__"):
        return value[0] if isinstance(value, bytes) else value
    fields = {name: of_store(getattr(value, name)) for name in value.__slots__}
    return STORE.types[value.__msgtype__](**fields)


class Publisher:
    def __init__(self, kind, qos):
        self.kind, self.qos, self.messages = kind, qos, []

    def publish(self, published):
        assert isinstance(published, self.kind)
        name = published.__msgtype__
        self.messages.append(STORE.deserialize_cdr(STORE.serialize_cdr(of_store(published), name), name))


class Node:
    given = {}

    def __init__(self, name):
        self.name, self.publishers_, self.callbacks, self.declared, self.said = name, {}, {}, {}, []

    def declare_parameter(self, name, default):
        value = self.given.get(name, default)
        assert type(value) is type(default), f"{name} is {value!r}"
        self.declared[name] = value
        return types.SimpleNamespace(value=value)

    def create_publisher(self, kind, topic, qos):
        self.publishers_[topic] = Publisher(kind, qos)
        return self.publishers_[topic]

    def create_subscription(self, kind, topic, callback, qos):
        self.callbacks[topic] = callback

    def get_logger(self):
        return types.SimpleNamespace(warning=self.said.append, error=self.said.append)

    def told(self, topic):
        return self.publishers_[topic].messages


def install(monkeypatch, with_azimuth=True):
    """From now on `import rclpy` and the messages' packages find these."""

    def module(name, **members):
        made = types.ModuleType(name)
        vars(made).update(members)
        monkeypatch.setitem(sys.modules, name, made)

    def messages(package, *names):
        module(package)
        module(f"{package}.msg", **{name: message(f"{package}/msg/{name}") for name in names})

    module("rclpy")
    module("rclpy.node", Node=Node)
    qos = types.SimpleNamespace
    module("rclpy.qos", QoSProfile=qos, DurabilityPolicy=qos(TRANSIENT_LOCAL=1), qos_profile_sensor_data=qos(depth=5))
    messages("sensor_msgs", "MagneticField", "Imu")
    messages("diagnostic_msgs", "DiagnosticArray", "DiagnosticStatus", "KeyValue")
    if with_azimuth:
        messages("compass_interfaces", "Azimuth")
