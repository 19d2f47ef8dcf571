"""Traces of what a link carries, and fitted models of networks."""

from collections.abc import Callable

from farhand.common.errors import TraceError
from farhand.netem.models.profiles import PROFILES, load_model
from farhand.netem.recordings.rate import load_rate_trace
from farhand.trials.fuzz.files import scratch
from farhand.trials.fuzz.target import Target, one_line


def seeds() -> list[bytes]:
    """A rate trace, and the models of some profiles."""
    import msgspec
    import tomli_w

    models = [profile.model for profile in PROFILES.values() if profile.model is not None][:3]
    texts = [
        tomli_w.dumps({"description": "x", "model": _without_nulls(msgspec.to_builtins(each))})
        for each in models
    ]
    return [b"\0" + b"# ms\n0\n1\n1\n5\n12\n", *(b"\1" + text.encode() for text in texts)]


def _without_nulls(value: object) -> object:
    if isinstance(value, dict):
        return {key: _without_nulls(inner) for key, inner in value.items() if inner is not None}
    return [_without_nulls(each) for each in value] if isinstance(value, list | tuple) else value


def start() -> Callable[[bytes], None]:
    """See Target."""
    path = scratch("rate")

    def take(data: bytes) -> None:
        path.write_bytes(data[1:])
        read: Callable[..., object] = load_model if data[:1] == b"\1" else load_rate_trace
        try:
            read(path)
        except TraceError as error:
            one_line(error)

    return take


TARGET = Target(
    edge="rate traces, fitted models",
    promise="a refusal is one line",
    seeds=seeds,
    start=start,
    shape="text",
    head=1,
)
