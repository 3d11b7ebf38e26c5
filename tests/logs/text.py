"""How text logs are written."""

import json

import numpy as np


def number(value: float, comma: bool) -> str:
    text = (
        f"{value:.0f}"
        if value == round(value) and abs(value) < 1e15
        else f"{value:.9g}"
        if abs(value) < 1e6
        else f"{value:.6f}"
    )
    return text.replace(".", ",") if comma else text


def rows(table: np.ndarray, delimiter: str, comma: bool) -> str:
    return "".join(delimiter.join(number(v, comma) for v in row) + "\n" for row in table.T)


def table(delimiter: str = ",", top: str = "", *, header: bool = True, mark: str = "", units_row: bool = False):
    """Return a writer of a table. With decimal commas cells are parted by semicolons."""

    def write(path, names, values, units, rate, comma):
        d = ";" if comma and delimiter == "," else delimiter
        head = mark + d.join(names) + "\n" if header else ""
        head += d.join(f"[{u}]" if u else "[-]" for u in units) + "\n" if units_row else ""
        path.write_text(top + head + rows(values, d, comma), encoding="utf-8")

    return write


def with_text(column: str, cell: str):
    """Return a writer of a table with a last column of text."""

    def write(path, names, values, units, rate, comma):
        d = ";" if comma else ","
        body = rows(values, d, comma).replace("\n", f"{d}{cell}\n")
        path.write_text(d.join([*names, column]) + "\n" + body, encoding="utf-8")

    return write


def scope(delimiter: str, *, full: bool, head: str, shared: bool = False, ticks: bool = False):
    """Return a writer of TwinCAT Scope's CSV. full: with every property; shared: one time column for all channels."""

    def write(path, names, values, units, rate, comma):
        d = delimiter
        time, data = values[0], values[1:]
        shown = np.round(133_000_000_000_000_000 + time * 1e4) if ticks else time
        keys = (
            ["Name", "SymbolComment", "Data-Type", "SampleTime[ms]", "VariableSize", "SymbolName", "Unit"]
            if full
            else ["Name"]
        )
        cells = {"Data-Type": "REAL64", "SampleTime[ms]": f"{1e3 / rate:g}", "VariableSize": "8", "SymbolComment": ""}
        lines = [head.replace("\t", d), ""]
        for key in keys:
            row = []
            for k, name in enumerate(names[1:]):
                row += [] if shared and k else [key]
                short = name.split(".")[-1]
                row.append(
                    {"Name": short, "SymbolName": f"Main.Axis1.{name}", "Unit": units[k + 1]}.get(
                        key, cells.get(key, "")
                    )
                )
            lines.append(d.join(row))
        lines.append("")
        for j in range(time.size):
            row = []
            for k in range(len(data)):
                row += [] if shared and k else [f"{shown[j]:.0f}" if ticks else number(shown[j], d != ",")]
                row.append(number(data[k, j], d != ","))
            lines.append(d.join(row))
        path.write_text("\n".join([*lines, "EOF" if full else ""]) + "\n", encoding="utf-8")

    return write


def echo(path, names, values, units, rate, comma):
    """`ros2 topic echo --csv /joint_states`: stamp, frame, names, positions, velocities, efforts."""
    joints = list(dict.fromkeys(n.split(".")[1] for n in names[1:]))
    order = [names.index(f"{f}.{j}") for f in ("position", "velocity", "effort") for j in joints]
    with path.open("w", encoding="utf-8") as file:
        for k, t in enumerate(values[0] + 1_760_000_000):
            sec, nano = int(t), round((t - int(t)) * 1e9)
            cells = [str(sec), str(nano), "base_link", *joints, *(f"{values[i, k]:.9g}" for i in order)]
            file.write(",".join(cells) + "\n")


def joint_states(path, names, values, units, rate, comma):
    """sensor_msgs/JointState, one message a line, as rosbridge and Foxglove write it."""
    joints = list(dict.fromkeys(n.split(".")[1] for n in names[1:]))
    with path.open("w", encoding="utf-8") as file:
        for k, t in enumerate(values[0] + 1_760_000_000):
            stamp = {"sec": int(t), "nanosec": round((t - int(t)) * 1e9)}
            fields = {
                f: [values[names.index(f"{f}.{j}"), k] for j in joints] for f in ("position", "velocity", "effort")
            }
            file.write(json.dumps({"header": {"stamp": stamp, "frame_id": ""}, "name": joints, **fields}) + "\n")


def lists(path, names, values, units, rate, comma):
    found = {}
    for name, v in zip(names, values, strict=True):
        place = found
        *groups, last = name.split(".")
        for group in groups:
            place = place.setdefault(group, {})
        place[last] = v.tolist()
    path.write_text(json.dumps(found), encoding="utf-8")
