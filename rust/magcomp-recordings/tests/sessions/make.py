"""Makes the binary sessions beside this file, which tests/import/ reads, with other people's writers:
pip install mcap-ros2-support==0.6.0 pyarrow==26.0.1"""

import pyarrow as pa
import pyarrow.feather as feather
import pyarrow.parquet as pq
from mcap_ros2.writer import Writer

HEADER = """std_msgs/Header header
{}
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
{}"""
VECTOR = """================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
"""
QUATERNION = """================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
"""
FIELD = HEADER.format("geometry_msgs/Vector3 magnetic_field\nfloat64[9] magnetic_field_covariance", VECTOR)
IMU = HEADER.format(
    "geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
    "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
    "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance",
    QUATERNION + VECTOR,
)


def xyz(x, y, z):
    return {"x": x, "y": y, "z": z}


def header(ns, frame):
    return {"stamp": {"sec": ns // 10**9, "nanosec": ns % 10**9}, "frame_id": frame}


def bag(name, stamped, topics):
    with open(name, "wb") as file:
        writer = Writer(file)
        field = writer.register_msgdef("sensor_msgs/msg/MagneticField", FIELD)
        imu = writer.register_msgdef("sensor_msgs/msg/Imu", IMU)
        other = writer.register_msgdef("std_msgs/msg/String", "string data")
        start = 1_700_000_000_000_000_000
        writer.write_message("/chatter", other, {"data": "hello"}, log_time=start)
        for k in range(5):
            ns = start + 10_000_000 * k
            # frame_id of every length modulo 8, so that the numbers' alignment is tried
            head = header(ns, "imu_link"[: 3 + k]) if stamped else header(0, "")
            for topic in topics:
                message = {"header": head, "magnetic_field": xyz(20e-6 + k * 1e-6, -5e-6, -40e-6), "magnetic_field_covariance": [0.0] * 9}
                writer.write_message(topic, field, message, log_time=ns + 1000)
            ns += 4_000_000
            head = header(ns, "imu_link"[: 3 + k]) if stamped else header(0, "")
            message = {
                "header": head,
                "orientation": {"w": 1.0, **xyz(0.0, 0.0, 0.0)},
                "orientation_covariance": [-1.0] + [0.0] * 8,
                "angular_velocity": xyz(0.1, 0.2, 0.25 * k),
                "angular_velocity_covariance": [0.0] * 9,
                "linear_acceleration": xyz(0.5, -0.25, 9.75),
                "linear_acceleration_covariance": [0.0] * 9,
            }
            writer.write_message("/imu/data_raw", imu, message, log_time=ns + 1000)
        writer.finish()


bag("ros2.mcap", True, ["/imu/mag"])
bag("ros2_two_topics.mcap", False, ["/imu/mag", "/gps/mag"])

times = [1_700_000_000_000_000_000 + 10_000_000 * k for k in range(4)]
columns = {
    "bx": pa.array([20.5, 21.5, None, 22.5], pa.float64()),
    "by": pa.array([-5.0, -5.5, None, -6.0], pa.float32()),
    "bz": pa.array([-40, -41, None, -42], pa.int32()),
    "rate_x": pa.array([0.125] * 4, pa.float64()),
    "rate_y": pa.array([0.25] * 4, pa.float64()),
    "rate_z": pa.array([0.5] * 4, pa.float64()),
    "note": pa.array(["a", "b,c", "d", "e"], pa.string()),
}
pq.write_table(pa.table({"time": pa.array(times, pa.int64()), **columns}), "table.parquet")
micros = pa.array([ns // 1000 for ns in times], pa.timestamp("us"))
pq.write_table(pa.table({"time": micros, **columns}), "table_timestamps.parquet", compression="zstd")
# as pandas stores its times
nanos = pa.array(times, pa.timestamp("ns"))
pq.write_table(pa.table({"time": nanos, **columns}), "table_nanoseconds.parquet")
table = pa.table({"time": nanos, **columns})
feather.write_feather(table, "table.feather", compression="lz4")
feather.write_feather(pa.table({"time": pa.array(times, pa.int64()), **columns}), "table_numbers.feather", compression="zstd")
with pa.ipc.new_stream("table.arrow", table.schema) as stream:
    # two batches
    stream.write_table(table, max_chunksize=3)
