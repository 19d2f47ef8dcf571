"""Cost of a message: encode and decode of each kind, validated, against plain msgpack in the same run.

`python -m benchmarks.messages [--quick] [--json FILE]`
"""

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgpack
import numpy as np
from rich.console import Console
from rich.table import Table

from farhand.common.messages.base import Echo, Message
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.command import VelocityCommand
from farhand.common.messages.scene import Obstacle, Scene
from farhand.common.messages.state import RobotState
from farhand.common.shapes.sphere import Sphere
from farhand.common.timing.clock import thread_seconds

REPEATS, BATCH = 60, 500
QUICK = 2, 5


def examples() -> list[Message]:
    """One of each kind that travels, as in the demo."""
    common = {"session": 7, "seq": 1, "t_sent_ns": 10**15, "echo": Echo(5, 3, 10**14, 10**6)}
    v = (0.1, -0.2, 0.3)
    return [
        VelocityCommand(source="operator", mode="run", velocity=v, plan=(v,) * 9, desired=v, **common),
        RobotState(
            source="ur5",
            t_sample_ns=10**15,
            position=v,
            velocity=v,
            joints=(0.1,) * 6,
            applied_session=7,
            clearance=0.2,
            min_clearance=0.1,
            arm_clearance=0.15,
            **common,
        ),
        Scene(
            source="ur5",
            t_sample_ns=10**15,
            targets=(v,) * 3,
            obstacles=tuple(Obstacle(id=f"o{k}", shape=Sphere(0.1), position=v) for k in range(10)),
            **common,
        ),
    ]


def _median(call: Callable[[], object], repeats: int, batch: int) -> float:
    times = []
    for _ in range(repeats):
        start = thread_seconds()
        for _ in range(batch):
            call()
        times.append((thread_seconds() - start) / batch)
    return float(np.median(times))


def run(repeats: int = REPEATS, batch: int = BATCH) -> dict[str, Any]:
    """Medians in s, and ratios to msgpack without validation."""
    found: dict[str, Any] = {}

    def median(call: Callable[[], object]) -> float:
        return _median(call, repeats, batch)

    for message in examples():
        payload = encode(message)
        plain = msgpack.unpackb(payload)
        decoder: Decoder[Any] = Decoder(type(message))
        encoding, decoding = (
            median(lambda m=message: encode(m)),
            median(lambda d=decoder, p=payload: d.decode(p)),
        )
        packing, unpacking = (
            median(lambda p=plain: msgpack.packb(p)),
            median(lambda p=payload: msgpack.unpackb(p)),
        )
        found[type(message).__name__] = {
            "bytes": len(payload),
            "encode": encoding,
            "decode_validated": decoding,
            "msgpack_encode": packing,
            "msgpack_decode": unpacking,
            "encode_ratio": encoding / packing,
            "decode_ratio": decoding / unpacking,
        }
    return found


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--quick", action="store_true", help="to see that it works; the figures mean nothing")
    options = parser.parse_args()
    found = run(*QUICK) if options.quick else run()
    table = Table("message", "bytes", "encode (us)", "decode, validated (us)", "msgpack, unvalidated (us)")
    for name, f in found.items():
        plain = f"{f['msgpack_encode'] * 1e6:.1f} / {f['msgpack_decode'] * 1e6:.1f}"
        row = (f"{f['encode'] * 1e6:.1f}", f"{f['decode_validated'] * 1e6:.1f}", plain)
        table.add_row(name, str(f["bytes"]), *row)
    Console(markup=False).print(table)
    if options.json:
        options.json.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
