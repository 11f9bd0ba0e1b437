"""The node `magcomp`: raw field and IMU in; bias, field without it, azimuth and diagnostics out. README.md has topics and parameters.

ROS bodies have x forward, y left, z up; magcomp's devices x right, y forward, z up. The heading is that of forward.
"""

import math
import os
import tempfile
import time

import magcomp
import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import Imu, MagneticField

from .order import Order

try:
    from compass_interfaces.msg import Azimuth
except ImportError:  # the distribution has no such package, or it is not installed
    Azimuth = None

# device axes of a body's vector
TO_DEVICE = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
TESLA = 1e-6  # of a microtesla
IMU, MAG = 0, 1
LEVELS = {
    "collecting": DiagnosticStatus.WARN,
    "tracking": DiagnosticStatus.OK,
    "suspect": DiagnosticStatus.WARN,
    "held": DiagnosticStatus.OK,
    "disturbed": DiagnosticStatus.WARN,
    "rejected": DiagnosticStatus.ERROR,
}


def _of(vector):
    return TO_DEVICE @ (vector.x, vector.y, vector.z)


def _put(vector, device):
    vector.x, vector.y, vector.z = (float(value) for value in TO_DEVICE.T @ device)


class Compass(Node):
    def __init__(self):
        super().__init__("magcomp")
        declare = lambda name, value: self.declare_parameter(name, value).value
        known = lambda value: None if math.isnan(value) else value
        self._declination_deg = known(declare("declination_deg", math.nan))
        self._compensator = magcomp.Compensator(
            method=declare("method", "Auto"),
            rail_ut=known(declare("rail_ut", math.nan)),
            heading={"declination_deg": self._declination_deg},
        )
        self._order = Order(round(1e9 * declare("hold_s", 0.05)))
        self._file = declare("calibration_file", "")
        self._adopt()
        self._imus_left_out = 0
        self._second = None
        self._told = None

        self._unbiased = self.create_publisher(MagneticField, "imu/mag_unbiased", 10)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._bias = self.create_publisher(MagneticField, "imu/mag_bias", latched)
        self._diagnostics = self.create_publisher(DiagnosticArray, "diagnostics", 10)
        self._azimuth = None
        if Azimuth is None:
            self.get_logger().warning("there is no azimuth: install compass_interfaces (apt install ros-$ROS_DISTRO-compass-interfaces)")
        else:
            reference = "mag" if self._declination_deg is None else "true"
            self._azimuth = self.create_publisher(Azimuth, f"compass/{reference}/enu/rad", 10)
        self.create_subscription(Imu, "imu/data", lambda message: self._add(IMU, message), qos_profile_sensor_data)
        self.create_subscription(MagneticField, "imu/mag", lambda message: self._add(MAG, message), qos_profile_sensor_data)

    def _add(self, topic, message):
        stamp = message.header.stamp
        for topic, time_ns, event in self._order.add(topic, stamp.sec * 1_000_000_000 + stamp.nanosec, message):
            if topic == MAG:
                self._answer(time_ns, event)
                continue
            is_whole = True
            for push, vector in (
                (self._compensator.push_rotation_rate, event.angular_velocity),
                (self._compensator.push_up, event.linear_acceleration),
            ):
                try:
                    push(time_ns, _of(vector))
                except magcomp.EventError:
                    is_whole = False
            self._imus_left_out += not is_whole

    def _answer(self, time_ns, message):
        reading = self._compensator.push(time_ns, _of(message.magnetic_field) / TESLA)
        if reading.field_ut is not None:
            out = MagneticField(header=message.header)
            _put(out.magnetic_field, reading.field_ut * TESLA)
            if reading.field_sigma_ut is not None:  # else zeros: not known
                out.magnetic_field_covariance = np.diag([(reading.field_sigma_ut * TESLA) ** 2] * 3).ravel()
            self._unbiased.publish(out)
        heading_deg = reading.heading_deg if self._declination_deg is None else reading.true_heading_deg
        if self._azimuth is not None and heading_deg is not None and reading.heading_sigma_deg is not None:
            out = Azimuth(header=message.header)
            out.azimuth = math.radians((90.0 - heading_deg) % 360.0)
            out.variance = math.radians(reading.heading_sigma_deg) ** 2
            out.unit, out.orientation = Azimuth.UNIT_RAD, Azimuth.ORIENTATION_ENU
            out.reference = Azimuth.REFERENCE_MAGNETIC if self._declination_deg is None else Azimuth.REFERENCE_GEOGRAPHIC
            self._azimuth.publish(out)
        second = time_ns // 1_000_000_000
        if second != self._second:
            self._second = second
            self._tell_bias(message.header)
            self._tell_diagnostics(message.header, reading)

    def _tell_bias(self, header):
        calibration = self._compensator.calibration
        if calibration is None:
            return
        bias, inverse = calibration.hard_iron_ut, np.linalg.inv(calibration.soft_iron)
        if self._told is not None and np.array_equal(self._told, (*bias, *inverse.flat)):
            return
        self._told = (*bias, *inverse.flat)
        out = MagneticField(header=header)
        _put(out.magnetic_field, bias * TESLA)
        # the pipeline's way to tell M^-1, row by row
        out.magnetic_field_covariance = (TO_DEVICE.T @ inverse @ TO_DEVICE).ravel()
        self._bias.publish(out)

    def _tell_diagnostics(self, header, reading):
        values = {
            "heading_deg": reading.heading_deg,
            "heading_sigma_deg": reading.heading_sigma_deg,
            "event": None if reading.event is None else f"{reading.event[0]} at {reading.event[1] * 1e-9:.3f} s",
            "imu_messages_left_out": self._imus_left_out,
        }
        status = DiagnosticStatus(level=LEVELS[reading.status], name="magcomp: magnetometer", message=reading.status_text)
        status.values = [KeyValue(key=key, value="" if value is None else str(value)) for key, value in values.items()]
        self._diagnostics.publish(DiagnosticArray(header=header, status=[status]))

    def _adopt(self):
        if not self._file or not os.path.exists(self._file):
            return
        try:
            with open(self._file) as file:
                self._compensator.adopt(file.read(), int(time.time()))
        except (OSError, UnicodeDecodeError, magcomp.KeptError) as error:
            self.get_logger().warning(f"{self._file}: {error}")

    def keep(self):
        """Writes what was learned into `calibration_file`, whole or not at all."""
        kept = self._compensator.keep(int(time.time())) if self._file else None
        if kept is None:
            return
        try:
            with tempfile.NamedTemporaryFile("w", dir=os.path.dirname(os.path.abspath(self._file)), delete=False) as file:
                file.write(kept)
            os.replace(file.name, self._file)
        except OSError as error:
            self.get_logger().error(f"the calibration was not kept: {error}")


def main():
    rclpy.init()
    node = Compass()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.keep()
        node.destroy_node()
        rclpy.try_shutdown()
