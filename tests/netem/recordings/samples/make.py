"""Makes the samples beside it, for tests alone: numbers drawn to look like recordings, measured nowhere.

python -m tests.netem.recordings.samples.make
"""

from pathlib import Path

import numpy as np

from farhand.common.seeds import stream

FOLDER = Path(__file__).parent
HEADER = "pub_time(ms) sub_time(ms) delay(ms) utmX(m) utmY(m) heading(rad) velocity(m/s) cellid(db) sinr(db) rsrp(db)"


def vehicle(rows: int, period: int, seed: int) -> str:
    """Round trips over 5G in the columns of the CICV5G data set; `period` in ms.

    A floor and a skewed jitter, two stalls that let go at once, and echoes that are lost: rows that are not there.
    """
    rng = stream(seed, "vehicle", f"{period}")
    sent = np.arange(rows) * period
    delay = 14.0 + rng.gamma(3.0, 3.0, rows)
    for begin, length in ((rows * 0.3, 420.0), (rows * 0.7, 260.0)):
        end = begin * period + length
        held = (sent >= begin * period) & (sent < end)
        delay[held] = end - sent[held] + 12.0
    arrives = rng.random(rows) > 0.01
    lines = [HEADER]
    for at, late in zip(sent[arrives].tolist(), np.rint(delay[arrives]).astype(int).tolist(), strict=True):
        now, moved = 1_700_000_000_000 + at, at * 6.0e-3
        place = f"{300_000 + moved:.6f} {3_400_000 + moved:.6f} 0.785398 6.000000"
        lines.append(f"{now} {now + late} {late} {place} 000000001 15 -90 ")
    return "\n".join(lines) + "\n"


def satellite(slots: int, seed: int) -> str:
    """One-way delays, one a slot of 10 ms: a level that jumps with each handover, jitter, and a few lost slots."""
    rng = stream(seed, "satellite")
    level = np.repeat(rng.uniform(20.0, 45.0, slots // 150 + 1), 150)[:slots]
    delay = np.rint(level + rng.gamma(2.0, 1.5, slots)).astype(int)
    lost = rng.random(slots) < 0.005
    words = ["lost" if gone else str(late) for late, gone in zip(delay.tolist(), lost.tolist(), strict=True)]
    return "\n".join(words) + "\n"


def samples() -> dict[str, str]:
    """Their text by file name."""
    return {
        "vehicle_5g_20hz.txt": vehicle(600, 50, 1),
        "vehicle_5g_100hz.txt": vehicle(600, 10, 2),
        "satellite_oneway_10ms_slots.txt": satellite(600, 3),
    }


if __name__ == "__main__":
    for name, text in samples().items():
        (FOLDER / name).write_text(text, encoding="utf-8")
