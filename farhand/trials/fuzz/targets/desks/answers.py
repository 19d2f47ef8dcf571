"""What running programs answer to the commands of a site: doctor, acknowledge, handover, netem's control."""

from collections.abc import Callable

import msgspec

from farhand.common.errors import InputError
from farhand.common.link.requests import answer_in
from farhand.site.clearing import Clearing
from farhand.site.doctor.path import decoded_facts
from farhand.trials.fuzz.target import Target, check, one_line


def seeds() -> list[bytes]:
    """A good one and a refusal."""
    answers: list[dict[str, object]] = [
        {"ok": True, "cleared": "no good command for 1.5 s"},
        {"ok": False, "error": "control was lost meanwhile"},
        {"schema": 4, "versions": {"python": "3.11"}, "session": 7},
    ]
    return [msgspec.json.encode(each) for each in answers]


def start() -> Callable[[bytes], None]:
    """See Target."""

    def take(data: bytes) -> None:
        clearing = Clearing("r", "me", 7)
        clearing.hear(data)
        try:
            found = answer_in(data)
        except InputError as error:
            one_line(error)
            found = {}
        check(not clearing.done or bool(found.get("ok")), "a stop counts as cleared that no answer says is")
        facts = decoded_facts(data)
        check(facts is None or isinstance(facts, dict), "facts that are none")

    return take


TARGET = Target(
    edge="answers of programs to doctor, acknowledge, handover, live control",
    promise="what is none is refused in one line, and no stop counts as cleared by it",
    seeds=seeds,
    start=start,
    shape="json",
    longest=2048,
)
