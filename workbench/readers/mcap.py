"""MCAP files, by mcap and mcap-ros2-support: messages in JSON or of ROS 2.

A column is a topic with the path of a number within its messages: "/joint_states.position.q7". Lists are called by the names
that lie beside them. A topic's instants are those of its headers' stamps, else of its log; "time" stands for them.
"""

import io
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from workbench.errors import WorkbenchError
from workbench.readers.flat import flattened
from workbench.readers.held import Held, Whole
from workbench.readers.limits import within
from workbench.readers.sheet import library

STAMPS = ("header.stamp", "stamp")


class Mcap(Whole):
    """See workbench.readers.Reader."""

    name = "mcap"
    suffixes = (".mcap",)

    def held(self, content: bytes, path: Path) -> Mapping[str, Held]:
        library("mcap", "mcap", path)
        try:
            topics = _topics(content, path)
        except WorkbenchError:
            raise
        except Exception as e:  # mcap raises whatever broken bytes lead to
            reason = " ".join(str(e).split())[:120] or type(e).__name__
            raise WorkbenchError(f"{path}: is no whole MCAP file ({reason}); record or copy it again.") from e
        found = {}
        for topic, messages in topics.items():
            found |= _columns(topic, messages)
        if not found:
            raise WorkbenchError(
                f"{path}: none of its topics holds numbers in every message; record the joint's states."
            )
        return found


def _topics(content: bytes, path: Path) -> dict[str, list]:
    """Return topic -> list of (log time in ns, flattened message)."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    reader = make_reader(io.BytesIO(content))
    summary = reader.get_summary()
    within(sum(c.uncompressed_size for c in summary.chunk_indexes) if summary else len(content), path)
    ros2, decoders, topics, unknown = DecoderFactory(), {}, {}, set()
    for schema, channel, message in reader.iter_messages():
        if channel.id not in decoders:
            told = (
                json.loads if channel.message_encoding == "json" else ros2.decoder_for(channel.message_encoding, schema)
            )
            decoders[channel.id] = told
        if decoders[channel.id] is None:
            unknown.add(channel.message_encoding)
            continue
        row = flattened(decoders[channel.id](message.data))
        topics.setdefault(channel.topic, []).append((message.log_time, row))
    if not topics and unknown:
        raise WorkbenchError(
            f"{path}: its messages are in {', '.join(sorted(unknown))}; read are JSON and the CDR of ROS 2, so convert it."
        )
    return topics


def _columns(topic: str, messages: list) -> dict[str, Held]:
    """Return the numbers that every message of a topic holds; a topic whose clock does not increase has none."""
    stamp = next((s for s in STAMPS if all(isinstance(row.get(s), float) for _, row in messages)), "")
    log = np.array([ns for ns, _ in messages], dtype=np.int64) / 1e9
    clock = np.array([row[stamp] for _, row in messages]) if stamp else log
    clock = clock if np.all(np.diff(clock) > 0) else log
    if clock.size < 2 or not np.all(np.diff(clock) > 0):
        return {}
    keys = [k for k in messages[0][1] if k not in STAMPS and all(_number(row.get(k)) for _, row in messages)]
    return {
        f"{topic}.{k}" if k else topic: Held(np.array([row[k] for _, row in messages], float), "", clock) for k in keys
    }


def _number(value: object) -> bool:
    return isinstance(value, (int, float))
