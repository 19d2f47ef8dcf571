"""Output of `hping3`: numbered answers with `rtt=7.8 ms`; missing numbers are lost messages, as with ping.

HPING host (eth0 192.0.2.1): S set, 40 headers + 0 data bytes
len=46 ip=192.0.2.1 ttl=64 DF id=0 sport=80 flags=SA seq=0 win=64240 rtt=7.8 ms
"""

from itertools import islice
from typing import ClassVar

from farhand.netem.recordings.formats.base import TraceText
from farhand.netem.recordings.formats.ping import Ping


class Hping3(Ping):
    """Output of hping3."""

    name: ClassVar[str] = "hping3"

    def matches(self, text: TraceText) -> bool:
        """Whether hping3's header or an answer with its words is near the beginning."""
        return any(
            line.startswith("HPING ") or (line.startswith("len=") and " rtt=" in line)
            for line in islice(text.lines, 1000)
        )
