"""Who may send what to whom: Zenoh access-control settings, derived from signed certificates.

Everything is denied but what a rule allows. A rule is looked up by the other end's certificate name, and its
keys are those of the robots that the certificate is named for:

| other end | may send | may receive |
|---|---|---|
| operator | the command of its robots, and changes of their scenes | state, scene and camera of its robots |
| robot | its own state, scene and camera | its own command |
| camera | the camera of its robots | state, scene and description of its robots |
| netem, router | what the other side of it may send to us | everything |
| observer | nothing | everything of its robots |

Liveliness tokens and the `about` question go along with that.
"""

from collections.abc import Iterable

from farhand.common.messages.keys import (
    PREFIX,
    about_key,
    alive_key,
    camera_key,
    command_key,
    description_key,
    report_key,
    scene_key,
    scene_request_key,
    state_key,
)
from farhand.common.trust.certificate import Member

Rule = tuple[str, tuple[str, ...], tuple[str, ...]]
_DECLARATIONS = (
    "declare_subscriber",
    "declare_queryable",
    "declare_liveliness_subscriber",
    "liveliness_query",
)
_EVERY_MESSAGE = ("put", "delete", *_DECLARATIONS, "query", "reply", "liveliness_token")
_EVERYTHING = ("**",)
_ALIVE = f"{PREFIX}/*/alive/*"
_NETEM_ALIVE = alive_key("netem", "netem")
_NETEM_ABOUT = about_key("netem", "netem")


def access_control(own: Member, others: Iterable[Member]) -> dict[str, object]:
    """The `access_control` settings of a session that belongs to `own`, for the other ends that it accepts."""
    rules: list[dict[str, object]] = []
    subjects: list[dict[str, object]] = []
    policies: list[dict[str, object]] = []
    for other in others:
        names = []
        for number, (flow, messages, keys) in enumerate(_rules(other, own)):
            if keys:
                names.append(f"{other.name}/{number}")
                rules.append(
                    {
                        "id": names[-1],
                        "permission": "allow",
                        "flows": [flow],
                        "messages": list(messages),
                        "key_exprs": list(keys),
                    }
                )
        subjects.append({"id": other.name, "cert_common_names": [other.name]})
        policies.append({"rules": names, "subjects": [other.name]})
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    }


def readable(own: Member) -> tuple[str, ...]:
    """Keys of the messages that a certificate lets its owner read."""
    if own.role == "robot":
        return _asked(own.robots)
    if own.role == "operator":
        return _seen(own.robots)
    if own.role == "camera":
        return _told(own.robots)
    if own.role == "observer":
        return _observed(own.robots)
    return _EVERYTHING


def _rules(other: Member, own: Member) -> list[Rule]:
    robots = other.robots
    if other.role == "operator":
        return [
            *_reader(robots, _seen(robots)),
            ("ingress", ("put",), _asked(robots)),
            ("ingress", ("liveliness_token",), tuple(alive_key(r, "operator") for r in robots)),
        ]
    if other.role == "observer":
        return _reader(robots, _observed(robots))
    if other.role == "camera":
        return [
            *_reader(robots, _told(robots)),
            ("ingress", ("put",), _pictured(robots)),
            ("ingress", ("liveliness_token",), tuple(alive_key(r, "camera") for r in robots)),
        ]
    if other.role == "robot":
        about = tuple(about_key(r, "robot") for r in robots)
        return [
            ("ingress", ("put",), _seen(robots)),
            ("ingress", ("declare_subscriber",), _asked(robots)),
            ("egress", ("put",), _asked(robots)),
            ("ingress", ("declare_queryable", "reply"), about),
            ("egress", ("query",), about),
            ("ingress", ("liveliness_token",), tuple(alive_key(r, "robot") for r in robots)),
            ("egress", _DECLARATIONS, _EVERYTHING),
        ]
    if other.role in ("netem", "router"):
        if own.role == "operator":
            sent = _seen(own.robots)
        elif own.role == "robot":
            sent = _asked(own.robots)
        elif own.role == "camera":
            sent = _told(own.robots)
        elif own.role == "observer":
            sent = _observed(own.robots)
        else:
            sent = (f"{PREFIX}/**",)
        return [
            ("ingress", ("put",), sent),
            ("ingress", (*_DECLARATIONS, "query", "reply", "liveliness_token"), _EVERYTHING),
            ("egress", _EVERY_MESSAGE, _EVERYTHING),
        ]
    return []


def _reader(robots: tuple[str, ...], keys: tuple[str, ...]) -> list[Rule]:
    """What one who looks at robots needs: their messages, who is alive, what they are."""
    about = (*(about_key(r, "robot") for r in robots), _NETEM_ABOUT)
    alive = (*(f"{PREFIX}/{r}/alive/*" for r in robots), _NETEM_ALIVE)
    return [
        ("ingress", ("declare_subscriber",), keys),
        ("egress", ("put", "delete"), keys),
        ("ingress", ("query",), about),
        ("egress", ("reply",), about),
        ("ingress", ("declare_liveliness_subscriber", "liveliness_query"), (_ALIVE, *alive)),
        ("egress", ("liveliness_token",), alive),
        ("egress", _DECLARATIONS, _EVERYTHING),
    ]


def _asked(robots: tuple[str, ...]) -> tuple[str, ...]:
    """What is asked of a robot: commands, changes of its scene."""
    return tuple(key for r in robots for key in (command_key(r), scene_request_key(r)))


def _told(robots: tuple[str, ...]) -> tuple[str, ...]:
    """What a robot says of itself: state, scene, description."""
    return tuple(key for r in robots for key in (state_key(r), scene_key(r), description_key(r)))


def _pictured(robots: tuple[str, ...]) -> tuple[str, ...]:
    """What cameras show of it."""
    return tuple(f"{camera_key(r)}/**" for r in robots)


def _seen(robots: tuple[str, ...]) -> tuple[str, ...]:
    """What an operator sees of a robot: what it says, and what cameras show."""
    return tuple(key for r in robots for key in (*_told((r,)), *_pictured((r,))))


def _observed(robots: tuple[str, ...]) -> tuple[str, ...]:
    """What an observer sees: what robots tell, commands, reports."""
    return _seen(robots) + tuple(map(command_key, robots)) + tuple(map(report_key, robots))
