"""Over what: a name and what it means, each direction."""

import hashlib
from functools import lru_cache
from pathlib import Path

from farhand.common.errors import InputError, SpecError
from farhand.common.recording.place import recording_at
from farhand.netem.models.profiles import PROFILES
from farhand.runs.run import read_way

_PAPERS = {
    "none": "none",
    "gaussian": "gaussian:50,20",
    "constant": "constant:200",
    "uniform": "uniform:50,200",
}
_LOSS = {f"loss-{share}": f"uniform:50,200 loss:{share}%" for share in (5, 10, 20, 40)}
_BURSTS = {
    "bursty-loss-5": "bursty-loss-5",
    "bursty-loss-10": "bursty-loss-10",
    "bursty-loss-20": "bursty-loss-20",
    "bursty-loss-40": "uniform:50,200 loss:gilbert(13.333%,20%)",
}
_OUTAGES = {
    f"outages-{length:g}s": f"constant:50 outage:every(10s,{length:g}s)" for length in (0.5, 1.0, 2.0, 5.0)
}

NETWORKS: dict[str, str] = {
    **_PAPERS,
    **_LOSS,
    **_BURSTS,
    "jump": "jump",
    "spikes": "spikes",
    **_OUTAGES,
    **{name: name for name in PROFILES if name not in _BURSTS and name not in ("jump", "spikes", "outages")},
}
"""None, the paper's, loss at random and in bursts of five, jumps, spikes, outages, and every named profile."""


@lru_cache(maxsize=256)
def content_of(name: str, text: str) -> str:
    """A digest of the files that a network's SPEC names, as this process read them first; empty without any.

    Raises:
        InputError: one cannot be read.
    """
    if name in NETWORKS:
        return ""
    spec = read_way(text).spec
    words = [*spec.words, *(word for _, own in spec.classes for word in own or ())]
    named = [Path(word.path) for word in words if hasattr(word, "path")]
    try:
        files = [(recording_at(path) if path.is_dir() else path).read_bytes() for path in named]
    except OSError as error:
        raise InputError(f"network {text}: {error.filename}: {error.strerror}") from None
    return hashlib.sha256(b"".join(files)).hexdigest()[:8] if files else ""


def check_content(name: str, text: str, key: str) -> None:
    """Raise InputError where a network's files are not those that a row is keyed by."""
    content = content_of(name, text)
    if content and not key.startswith(f"{name}@{content}/"):
        raise InputError(f"the files of {name} have changed since the table was begun; run the command again")


def networks_named(words: list[str]) -> dict[str, str]:
    """SPEC by name, from names with commas between them or SPECs, one an argument; raises SpecError.

    A SPEC, such as `trace:FILE`, is its own name.
    """
    found: dict[str, str] = {}
    for text in words:
        names = [name.strip() for name in text.split(",") if name.strip()]
        if names and all(name in NETWORKS for name in names):
            found |= {name: NETWORKS[name] for name in names}
            continue
        try:
            read_way(text)
        except SpecError as error:
            if all(c.isalnum() or c in "-.,_ " for c in text):
                raise SpecError(
                    f"--networks {text!r}: must be some of {', '.join(NETWORKS)}, or a SPEC"
                ) from None
            raise SpecError(f"--networks: {error}") from None
        found[text] = text
    if not found:
        raise SpecError(f"--networks: names none of {', '.join(NETWORKS)}")
    return found
