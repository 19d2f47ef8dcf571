"""What pages are told, as builtin types that MessagePack knows: a frame many times a second, the rest on change."""

from dataclasses import asdict, replace
from typing import Any

import msgspec

from farhand.common.messages.description import RobotDescription
from farhand.common.messages.report import ControlReport
from farhand.common.messages.scene import Scene
from farhand.operator_side.console.nearness import tool_to
from farhand.operator_side.console.network import NetworkTold
from farhand.operator_side.console.picture import NEVER, Picture
from farhand.operator_side.console.seat import Seat
from farhand.operator_side.console.status import LATE_AFTER, Situation, reasons, unheard


def _words(text: str) -> tuple[str, ...]:
    return tuple(text.split())


_STATE = _words(
    """t_sample_ns position orientation velocity joints mode reason holder_name clearance min_clearance arm_clearance
    applied_session applied_seq"""
)
_REPORT = _words(
    """session seq mode desired filtered desired_angular angular intervening predicted predicted_orientation inflation
    sigma margin_parts rtt_mean rtt_std loss binding clearance free_side stop_reason target_index target_count safety"""
)


def situation(
    picture: Picture,
    seat: Seat,
    now_ns: int,
    *,
    outage: bool,
    frozen: float,
    was_lost: float,
) -> Situation:
    """What the status is made from; for the last three see there."""
    report_age, state_age = picture.ages(now_ns)
    driver = seat.pages.get(seat.driver)
    return Situation(
        picture.report,
        picture.state,
        report_age,
        state_age,
        driver=driver.name if driver is not None else "",
        asks=next((page.name for page in seat.pages.values() if page.asks), ""),
        holds=seat.holds(now_ns),
        stopping=seat.stopping,
        outage=outage,
        frozen=frozen,
        was_lost=was_lost,
        near=tool_to(picture, picture.report.binding) if picture.report and picture.report.binding else None,
        stopped_by=seat.stopped_by,
    )


def frame(
    picture: Picture,
    seat: Seat,
    now: Situation,
    network: NetworkTold | None,
    number: int,
    now_ns: int,
) -> dict[str, Any]:
    """What page `number` is told of one instant."""
    state, report = picture.state, picture.report
    page = seat.pages.get(number)
    now = replace(now, watches=number != seat.driver, you=page.name if page is not None else "")
    return {
        "kind": "frame",
        "stamp": now_ns // 1_000_000,
        "state": {name: getattr(state, name) for name in _STATE} if state is not None else None,
        "guard": msgspec.to_builtins(state.guard) if state is not None and state.guard else None,
        "report": _report(report) if report is not None else None,
        "age": _age(now.state_age),
        "report_age": _age(now.report_age),
        "path": picture.path if not unheard(now) else [],
        "reasons": [asdict(reason) for reason in reasons(now)],
        "locked": seat.locked,
        "you": number,
        "driver": seat.driver,
        "driver_name": now.driver,
        "asking": [[n, each.name] for n, each in seat.pages.items() if each.asks],
        "watching": len(seat.pages) - (1 if seat.driver else 0),
        "holds": now.holds,
        "stands": now.holds and now.short is not None and now.short.unfollowed,
        "stopping": now.stopping,
        "heard": page.steer.press if page is not None and page.steer is not None else 0,
        "counts": seat.counts(number, now_ns),
        "late": seat.strays(number, now_ns),
        "recording": _recording(now),
        "networks": _network(network, changeable=number == seat.driver) if network is not None else None,
    }


def _report(report: ControlReport) -> dict[str, Any]:
    limit = None if report.limit is msgspec.UNSET else report.limit
    return {name: getattr(report, name) for name in _REPORT} | {"limit": limit}


def _recording(now: Situation) -> bool | None:
    """Whether a recorder writes; None: none ever did, or it is not known by now."""
    if now.report is None or now.report.recording is msgspec.UNSET or now.report_age > LATE_AFTER:
        return None
    return now.report.recording


def scene_told(scene: Scene) -> dict[str, Any]:
    """Obstacles and targets."""
    return {
        "kind": "scene",
        "t_sample_ns": scene.t_sample_ns,
        "obstacles": [_obstacle(msgspec.to_builtins(each)) for each in scene.obstacles],
        "targets": [list(target) for target in scene.targets],
    }


def robot_told(robot: RobotDescription) -> dict[str, Any]:
    """What the robot is."""
    return {
        "kind": "robot",
        "name": robot.source,
        "model": robot.model,
        "joints": list(robot.joint_names),
        "radius": robot.radius,
        "lag": robot.lag,
    }


def _obstacle(found: dict[str, Any]) -> dict[str, Any]:
    """With all that is left out on the wire where it is a default."""
    return {"orientation": (1.0, 0.0, 0.0, 0.0), "velocity": (0.0, 0.0, 0.0)} | found


def _network(network: NetworkTold, *, changeable: bool) -> dict[str, Any]:
    return {**asdict(network), "name": network.name, "changeable": changeable}


def _age(seconds: float) -> float | None:
    return None if seconds >= NEVER else round(seconds, 3)
