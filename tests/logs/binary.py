"""How binary logs are written: by the format's own library, or after its specification."""

import json
import struct

import numpy as np

JOINT_STATE = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""


def parquet(path, names, values, units, rate, comma):
    import pyarrow as pa
    import pyarrow.parquet as pq

    fields = [
        pa.field(n, pa.float64(), metadata={b"unit": u.encode()} if u else None)
        for n, u in zip(names, units, strict=True)
    ]
    pq.write_table(pa.table([pa.array(v) for v in values], schema=pa.schema(fields)), path)


def excel(path, names, values, units, rate, comma):
    import openpyxl

    book = openpyxl.Workbook(write_only=True)
    sheet = book.create_sheet("Measurement")
    for row in (["Oscilloscope export"], [], names, *values.T.tolist()):
        sheet.append(row)
    book.save(path)


def hdf5(path, names, values, units, rate, comma):
    import h5py

    with h5py.File(path, "w") as file:
        for name, unit, v in zip(names, units, values, strict=True):
            place = name.replace(".", "/")
            file[place] = v
            file[place].attrs["units"] = unit


def mat_struct(path, names, values, units, rate, comma):
    import scipy.io

    fields = {n.split(".")[1]: v for n, v in zip(names, values, strict=True)}
    scipy.io.savemat(path, {"log": fields, "Ts": 1.0 / rate, "comment": "identification run"}, do_compression=True)


def mat_matrix(path, names, values, units, rate, comma):
    import scipy.io

    scipy.io.savemat(path, {"ScopeData": values.T})


def npz(path, names, values, units, rate, comma):
    np.savez(path, **dict(zip(names, values, strict=True)))


def tdms(path, names, values, units, rate, comma):
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(str(path)) as writer:
        writer.write_segment(
            [ChannelObject("Axis", n, v, {"unit_string": u}) for n, v, u in zip(names, values, units, strict=True)]
        )


def mdf(path, names, values, units, rate, comma):
    from asammdf import MDF, Signal

    time = values[names.index("time")]
    with MDF(version="4.10") as file:
        file.append(
            [Signal(v, time, name=n, unit=u) for n, v, u in zip(names, values, units, strict=True) if n != "time"]
        )
        file.save(path, overwrite=True)


def mcap_ros2(path, names, values, units, rate, comma):
    from mcap_ros2.writer import Writer

    joints = list(dict.fromkeys(n.split(".")[-1] for n in names[1:]))
    rows = {
        f: np.array([values[names.index(f"/joint_states.{f}.{j}")] for j in joints]).T
        for f in ("position", "velocity", "effort")
    }
    with path.open("wb") as file:
        writer = Writer(file)
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        for k, t in enumerate(values[0] + 1_760_000_000):
            ns = round(t * 1e9)
            stamp = {"sec": ns // 10**9, "nanosec": ns % 10**9}
            message = {
                "header": {"stamp": stamp, "frame_id": ""},
                "name": joints,
                **{f: rows[f][k].tolist() for f in rows},
            }
            writer.write_message("/joint_states", schema, message, log_time=ns, publish_time=ns)
        writer.finish()


def mcap_json(path, names, values, units, rate, comma):
    from mcap.writer import Writer

    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("drive", "jsonschema", b"{}")
        fast = writer.register_channel("/drive", "json", schema)
        slow = writer.register_channel("/thermal", "json", schema)
        for k, t in enumerate(values[0] + 1_760_000_000):
            row = {n.removeprefix("/drive."): v for n, v in zip(names[1:], values[1:, k].tolist(), strict=True)}
            writer.add_message(fast, round(t * 1e9), json.dumps(row).encode(), round(t * 1e9))
            if k % 100 == 0:
                writer.add_message(
                    slow, round(t * 1e9), json.dumps({"winding": 30 + 0.01 * k}).encode(), round(t * 1e9)
                )
        writer.finish()


def wpilog(path, names, values, units, rate, comma):
    """After WPILib's specification: entry 0 starts entries, each value is a record with its time in us."""
    head = b"WPILOG" + struct.pack("<HI", 0x0100, 0)
    body = bytearray()

    def put(entry: int, time: int, payload: bytes):
        body.append(0b0111_1100)  # one byte of entry, four of size, eight of time
        body.extend(
            entry.to_bytes(1, "little") + len(payload).to_bytes(4, "little") + time.to_bytes(8, "little") + payload
        )

    def text(t: str) -> bytes:
        return struct.pack("<I", len(t)) + t.encode()

    for k, name in enumerate(names[1:], 1):
        put(0, 0, b"\0" + struct.pack("<I", k) + text(name) + text("double") + text(""))
    for j, t in enumerate(values[0]):
        for k in range(1, len(names)):
            put(k, round(t * 1e6) + 1, struct.pack("<d", values[k, j]))
    path.write_bytes(head + bytes(body))
