"""What single packets suffer on the way from one network namespace to another: UDP, one process, one clock."""

import ctypes
import os
import select
import socket
import struct
import threading
from typing import NamedTuple

import numpy as np

from farhand.common.errors import FarhandError
from farhand.common.geometry import Array
from farhand.common.timing.clock import SystemClock, to_ns

PORT = 7459
_NEW_NETWORK = 0x40000000
_NO_CHECK = 11
"""SO_NO_CHECK: without a checksum a flipped bit arrives, and can be counted."""
_FORCE_SEND_BUFFER, _FORCE_RECEIVE_BUFFER = 32, 33
"""SO_SNDBUFFORCE, so that a queue of packets does not hold up the sender; SO_RCVBUFFORCE."""
WARM_UP, _WARM = 100, 0xFFFFFFFF
"""Packets at most that go ahead, uncounted, and their number."""
_FORM = struct.Struct("<IQ")


class PacketsSeen(NamedTuple):
    """What came of the packets.

    Attributes:
        delays: (sent,) from sending to the first arrival (s); NaN where none came.
        order: numbers in the order of arrival, copies left out.
        copies: arrivals beyond the first of a packet.
        corrupted: arrivals with a flipped bit; counted here alone.
    """

    delays: Array
    order: tuple[int, ...]
    copies: int
    corrupted: int

    @property
    def lost(self) -> float:
        """Fraction that never came."""
        return float(np.mean(np.isnan(self.delays)))

    @property
    def burst(self) -> float:
        """Mean number of packets lost in a row; 0 where none was."""
        gone = np.isnan(self.delays)
        starts = int(np.sum(gone & ~np.concatenate([[False], gone[:-1]])))
        return float(np.sum(gone) / starts) if starts else 0.0

    @property
    def overtaken(self) -> float:
        """Fraction of the arrivals that came after a later one."""
        newest = np.maximum.accumulate(np.array(self.order)) if self.order else np.zeros(0)
        return float(np.mean(np.array(self.order) < newest)) if self.order else 0.0

    def summary(self) -> dict[str, float]:
        """mean, std, p50, p99 of the delays (s), lost and overtaken (fractions), burst; NaN if nothing came."""
        came = self.delays[~np.isnan(self.delays)]
        found = {
            "mean": float(came.mean()) if len(came) else float("nan"),
            "std": float(came.std()) if len(came) else float("nan"),
            "p50": float(np.percentile(came, 50)) if len(came) else float("nan"),
            "p99": float(np.percentile(came, 99)) if len(came) else float("nan"),
        }
        return found | {"lost": self.lost, "burst": self.burst, "overtaken": self.overtaken}


def socket_in(namespace: str) -> socket.socket:
    """A UDP socket of a namespace that `ip netns` made; raises FarhandError."""
    found: list[socket.socket | OSError] = []

    def make() -> None:  # in a thread of its own: it alone changes its namespace
        try:
            with open(f"/run/netns/{namespace}") as place:
                if ctypes.CDLL(None, use_errno=True).setns(place.fileno(), _NEW_NETWORK):
                    raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
            found.append(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        except OSError as error:
            found.append(error)

    thread = threading.Thread(target=make)
    thread.start()
    thread.join()
    if isinstance(found[0], OSError):
        raise FarhandError(f"network namespace {namespace}: {found[0]}")
    return found[0]


def probe(
    here: str, there: str, address: str, count: int, interval: float, size: int = 100, patience: float = 2.0
) -> PacketsSeen:
    """Send packets from a namespace to another and see when they come.

    Args:
        here, there: namespaces.
        address: of `there`.
        count, interval: how many, and how far apart (s).
        size: of the payload (bytes), at least 12.
        patience: how long to wait after the last (s).
    """
    clock = SystemClock()
    with socket_in(here) as sender, socket_in(there) as receiver:
        sender.setsockopt(socket.SOL_SOCKET, _NO_CHECK, 1)
        sender.setsockopt(socket.SOL_SOCKET, _FORCE_SEND_BUFFER, 50_000_000)
        receiver.setsockopt(socket.SOL_SOCKET, _FORCE_RECEIVE_BUFFER, 50_000_000)
        receiver.bind((address, PORT))
        receiver.setblocking(False)
        rest = bytes(size - _FORM.size)
        _meet(sender, receiver, address, rest)
        stamps: list[int] = []
        delays = np.full(count, np.nan)
        order: list[int] = []
        copies = corrupted = 0
        start_ns, step_ns = clock.now_ns(), to_ns(interval)
        end_ns = start_ns + count * step_ns + to_ns(patience)
        while (now_ns := clock.now_ns()) < end_ns:
            if len(stamps) < count and now_ns >= start_ns + len(stamps) * step_ns:
                stamps.append(now_ns)
                sender.sendto(_FORM.pack(len(stamps) - 1, now_ns) + rest, (address, PORT))
                continue
            next_ns = start_ns + len(stamps) * step_ns if len(stamps) < count else end_ns
            if not select.select([receiver], [], [], max(0, next_ns - now_ns) * 1e-9)[0]:
                continue
            try:
                packet = receiver.recv(65535)
            except BlockingIOError:  # its header was corrupted: the kernel threw it away after all
                continue
            now_ns = clock.now_ns()
            number, stamp_ns = _FORM.unpack_from(packet)
            if number == _WARM and stamp_ns == 0:
                continue
            if number >= len(stamps) or stamps[number] != stamp_ns or packet[_FORM.size :] != rest:
                corrupted += 1
            elif not np.isnan(delays[number]):
                copies += 1
            else:
                delays[number] = (now_ns - stamp_ns) * 1e-9
                order.append(number)
    return PacketsSeen(delays, tuple(order), copies, corrupted)


def _meet(sender: socket.socket, receiver: socket.socket, address: str, rest: bytes) -> None:
    """Send until something comes: the first packets wait for the neighbour's address, which is delayed and lost too."""
    for _ in range(WARM_UP):
        sender.sendto(_FORM.pack(_WARM, 0) + rest, (address, PORT))
        if select.select([receiver], [], [], 0.05)[0]:
            return
