"""The program `farhand camera`: pictures of the robot, or from a camera, beside a running robot's program."""

from contextlib import ExitStack
from dataclasses import dataclass

from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.keys import check_robot_name, scene_key, state_key
from farhand.common.process.security import Access, guard, secure
from farhand.common.process.signals import PeerWatch, say, stop_event_on_signals
from farhand.common.process.teller import Teller
from farhand.common.timing.clock import SystemClock
from farhand.common.trust.zenoh_log import tell_refusals
from farhand.programs.sessions import random_session
from farhand.robot_side.camera.camera_node import CameraNode, encoder
from farhand.robot_side.camera.main import run_camera
from farhand.robot_side.camera.settings import VIEW, Pictures
from farhand.robot_side.camera.source import CameraSource
from farhand.runs.scenario import Scenario


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraOptions:
    """What `farhand camera` is asked for beside the scenario and how it meets the others.

    Attributes:
        robot: its name, part of the keys.
        camera: `pybullet` or `device:PATH`.
        pictures: how large, how many, how good.
    """

    robot: str
    camera: str
    pictures: Pictures


def camera_program(scenario: Scenario, access: Access, options: CameraOptions) -> int:
    """Send pictures until it is told to end; raises InputError."""
    name = check_robot_name(options.robot)
    mode = access.mode
    compress = encoder()
    folder = secure(access, lambda line: say("camera", line), "camera", name)
    stop_event, clock = stop_event_on_signals(), SystemClock()
    with ExitStack() as closing:
        teller = Teller("camera")
        closing.callback(teller.close)
        if folder is not None:
            tell_refusals(teller.say)
        source = _source(scenario, options, clock)
        closing.callback(source.close)
        extra = folder.settings("camera") if folder else ()
        session = open_session(access.connect, access.listen, mode=mode, extra=extra)
        link = ZenohLink(session, [state_key(name), scene_key(name)], clock)
        closing.callback(link.close)
        guard(session, folder, name, "camera", teller.say)
        PeerWatch("camera", access.where, link.connected, stop_event)
        wanted = options.pictures
        teller.say(
            f"{options.camera} of {name!r} at {access.where}, {wanted.width}x{wanted.height} at "
            f"{wanted.rate_hz:g} Hz; Ctrl-C ends it"
        )
        node = CameraNode(name, random_session(), link, source, wanted, compress)
        run_camera(node, clock, stop_event, teller.say)
    say("camera", f"ended after {node.sent} pictures")
    return 0


def _source(scenario: Scenario, options: CameraOptions, clock: SystemClock) -> CameraSource:
    if options.camera == VIEW:
        from farhand.robot_side.camera.view import BulletView

        return BulletView(scenario.robot, scenario.camera, options.pictures)
    from farhand.robot_side.camera.device import DeviceCamera

    return DeviceCamera(options.camera, options.pictures, clock.now_ns)
