"""The robot's program as one node.

Data flow of a tick at `now_ns`:

    link -> command intake (decode, count) -> watchdog (lease, age, order, timeouts, plan play-out)
         -> guard, on the true state (of a robot that is a sphere here, of an arm within its control)
         -> robot (velocity control, physics) over [now, now + dt]
    link <- RobotState at the state rate, Scene and RobotDescription once a second and on change

The sample in a RobotState is the state at `now_ns`, before that tick's step.
"""

import math
from collections.abc import Sequence

import msgspec

from farhand.common.geometry import STILL, Twist
from farhand.common.link.link import Link, Packet
from farhand.common.messages.base import SafetyMode, Vector3
from farhand.common.messages.codec import encode
from farhand.common.messages.description import RobotDescription
from farhand.common.messages.keys import description_key, scene_key, state_key
from farhand.common.messages.scene import Obstacle, Scene
from farhand.common.messages.state import RobotState
from farhand.common.shapes.distance import nearest_obstacle
from farhand.common.timing.clock import to_ns
from farhand.common.timing.periodic import Periodic
from farhand.robot_side.result import GuardedPair, RobotResult
from farhand.robot_side.robots.approach import Approach
from farhand.robot_side.robots.newcomers import crowded_by
from farhand.robot_side.robots.robot import Robot, RobotSample
from farhand.robot_side.robots.settings import RobotScenario
from farhand.robot_side.run_statistics import RunStatistics
from farhand.robot_side.safety.command_intake import CommandIntake
from farhand.robot_side.safety.guard.tally import Tally
from farhand.robot_side.safety.guard.tool_guard import ToolGuard
from farhand.robot_side.safety.scene_intake import SceneIntake
from farhand.robot_side.safety.watchdog import Watchdog
from farhand.robot_side.scene.obstacle_field import NOTHING_NEAR, ObstacleField

SECOND_NS = 1_000_000_000
UNHEARD = "no good command"
CATCH_UP_NS = 100_000_000  # a simulator makes good for at most this much lost time a tick


class RobotNode:
    """A robot behind a link. `step` never raises: any failure inside it stops the robot.

    Args:
        scenario: settings, obstacles, targets.
        robot: what moves.
        link: the robot's end of the network.
        name: part of the keys.
        session: random, not 0, new at each start of the process.
    """

    def __init__(self, scenario: RobotScenario, robot: Robot, link: Link, name: str, session: int) -> None:
        settings = scenario.robot
        self._settings, self._safety = settings, scenario.safety
        self._targets = scenario.targets
        self._obstacles = scenario.obstacles
        self._radius = settings.radius
        self._robot = robot
        self._link = link
        self._name = name
        self._state_key = state_key(name)
        self._session = session
        self._period_ns = round(SECOND_NS / settings.rate_hz)
        self._dt = 1.0 / settings.rate_hz
        self._ticks = Periodic(self._period_ns)
        state_period_ns = max(self._period_ns, round(SECOND_NS / settings.state_rate_hz))
        self._state_due = Periodic(state_period_ns)
        self._scene_due = Periodic(SECOND_NS)
        self._scene_changed = False
        self._shown_holder = 0
        self._state_seq = 0
        self._scene_seq = 0
        self._field: ObstacleField | None = None
        self._sample = robot.sample()
        self._clearance = NOTHING_NEAR
        self._statistics = RunStatistics(settings.rate_hz)
        self._stepped = 0
        self._nearest_part = "", ""
        # to what it came nearest before the scene was changed
        self._named_nearest: tuple[tuple[Vector3, int] | None, str] = None, ""
        self._guarded = scenario.guard.on
        self._d_min = scenario.guard.d_min
        self._guard: ToolGuard | None = None
        if self._guarded and not robot.guards_itself:
            self._guard = ToolGuard(
                scenario.guard, settings.radius, settings.lag, self._dt, scenario.safety.max_speed
            )
        self._approach = Approach(robot, settings.radius, self._d_min, self._period_ns)
        self._evades = False  # whether its guard may move it though it is latched
        self._now_ns = 0
        self._tally = Tally(self._dt)
        self.watchdog = Watchdog(scenario.safety, session)
        self.intake = CommandIntake(name, self.watchdog)
        self.scene_intake = SceneIntake(name, scenario.safety, session)

    @property
    def trajectory(self) -> list[tuple[float, float, float, float, float]]:
        """(t, x, y, z, clearance) at 50 Hz, t in s since the first tick."""
        return self._statistics.trajectory

    def step(self, now_ns: int) -> int:
        """Do all ticks that are due; returns the instant of the next one (ns)."""
        periods = self._ticks.due(now_ns)
        if periods:
            try:
                self._tick(now_ns, periods)
            except Exception as error:
                self._stand_still(error, now_ns)
            if self._state_due.due(now_ns):
                self._send_state(now_ns)
            self._send_scene_if_due(now_ns)
        next_ns = self._ticks.next_ns
        return now_ns + self._period_ns if next_ns is None else next_ns

    def replace_obstacles(self, obstacles: Sequence[Obstacle], now_ns: int) -> None:
        """From `now_ns` on the obstacles are these; the operator is told with the next tick."""
        self._named_nearest = self._statistics.nearest, self._nearest_obstacle()
        self._obstacles = tuple(obstacles)
        self._field = ObstacleField(self._obstacles, now_ns)
        self._scene_changed = True

    def summary(self) -> RobotResult:
        """What happened so far."""
        watchdog, statistics = self.watchdog, self._statistics
        nearest = statistics.min_clearance
        return RobotResult(
            min_clearance=nearest if nearest < NOTHING_NEAR else None,
            min_arm_clearance=statistics.min_arm_clearance,
            path_length=statistics.path_length,
            ticks=self._stepped,
            overruns=self._ticks.overruns,
            states_sent=self._state_seq,
            commands_received=self.intake.received,
            refused=self.intake.refused(),
            stops=watchdog.stops,
            holds=watchdog.holds,
            position=self._sample.position,
            mode=watchdog.mode,
            reason=watchdog.reason,
            longest_silence=statistics.longest_silence,
            began=self._began(),
            interruptions=self._interruptions_so_far(),
            nearest_obstacle=self._nearest_obstacle(),
            nearest_part=self._nearest_part[0],
            nearest_to_arm=self._nearest_part[1],
            guarded=self._guarded,
            guard_times=self._tally.times,
            guard_seconds=self._tally.seconds,
            guard_deeds=dict(self._tally.deeds),
            guard_pairs=self._guard_pairs(),
            changes=[(c.t_ns, c.mode, c.reason) for c in watchdog.changes],
            trajectory=statistics.trajectory,
            scene_changes=self.scene_intake.revision,
            scene_refused=self.scene_intake.refused,
        )

    def _guard_pairs(self) -> list[GuardedPair]:
        pairs = [
            GuardedPair(part=part, obstacle=obstacle, seconds=seconds, distance=distance)
            for (part, obstacle), (seconds, distance) in self._tally.pairs.items()
        ]
        return sorted(pairs, key=lambda pair: -pair.seconds)

    def _nearest_obstacle(self) -> str:
        nearest = self._statistics.nearest
        if nearest is None or self._field is None:
            return ""
        if nearest == self._named_nearest[0]:
            return self._named_nearest[1]
        position, at_ns = nearest
        return nearest_obstacle(self._field.at(at_ns), position)[1]

    def _began(self) -> float | None:
        first_ns, start_ns = self.watchdog.first_run_ns, self._statistics.start_ns
        return (first_ns - start_ns) * 1e-9 if first_ns is not None and start_ns is not None else None

    def _interruptions_so_far(self) -> list[tuple[float, SafetyMode, str]]:
        """Holds for want of commands, and stops."""
        start_ns = self._statistics.start_ns or 0
        return [
            ((c.t_ns - start_ns) * 1e-9, c.mode, c.reason)
            for c in self.watchdog.changes
            if c.mode in ("stopped", "estop") or (c.mode == "hold" and c.reason.startswith(UNHEARD))
        ]

    def _tick(self, now_ns: int, periods: int) -> None:
        watchdog, field = self.watchdog, self._field
        if field is None:
            field = self._field = ObstacleField(self._obstacles, now_ns)
        if periods > 1 and self._robot.catches_up:
            self._catch_up(field, now_ns, periods - 1)
        watchdog.tick(now_ns)
        packets = self._link.receive()
        if packets:
            self.intake.take(packets, now_ns)
            self.scene_intake.take(packets)
        self._note_silence(now_ns)
        self._observe(field, now_ns)
        if self.scene_intake.waits:
            field = self._change_scene(field, now_ns)
        why = self._robot.stopped_by()
        if why:  # the robot itself says that it is stopped
            watchdog.block(why, now_ns)
        self._move(field, now_ns)

    def _change_scene(self, field: ObstacleField, now_ns: int) -> ObstacleField:
        """Judge one request; guard, clearances and what is announced have the new scene from this tick on."""
        found = self.scene_intake.judge(field.at(now_ns), now_ns, self._crowded)
        if found is not None:
            self.replace_obstacles(found, now_ns)
        return self._field or field

    def _crowded(self, obstacles: Sequence[Obstacle]) -> str:
        guard = self._guard if self._guard is not None else self._guarded
        return crowded_by(obstacles, self._robot, self._sample, self._radius, guard, self._d_min)

    def _catch_up(self, field: ObstacleField, now_ns: int, behind: int) -> None:
        for missed in range(min(behind, CATCH_UP_NS // self._period_ns), 0, -1):
            then_ns = now_ns - missed * self._period_ns
            self.watchdog.tick(then_ns)
            self._observe(field, then_ns)
            self._move(field, then_ns)

    def _note_silence(self, now_ns: int) -> None:
        """How long the one in control is silent; nobody is expected to speak after a release."""
        newest, lease = self.intake.newest, self.watchdog.lease
        if newest.seq >= 0 and (lease.holder or lease.end == "silent"):
            self._statistics.add_silence(now_ns - newest.arrived_ns)

    def _observe(self, field: ObstacleField, now_ns: int) -> None:
        sample = self._robot.sample()
        if not _finite(sample):
            raise ArithmeticError("the robot's state is not finite")
        self._sample = sample
        self._clearance = field.clearance(sample.position, self._radius, now_ns)
        self._statistics.add(now_ns, sample.position, self._clearance)

    def _move(self, field: ObstacleField, now_ns: int) -> None:
        # The one place between what the operator may ask for and what the robot does.
        watchdog, self._now_ns = self.watchdog, now_ns
        if not self._guarded:
            self._robot.step(watchdog.twist(now_ns), self._dt)
        elif watchdog.latched and (watchdog.stands(now_ns, self._comes) or not field.moves):
            self._robot.halt(self._dt)
            self._tally.forget()
            self._evades = False
        else:
            self._evades = watchdog.latched
            if self._evades:
                self._robot.rest()
            self._move_guarded(watchdog.twist(now_ns), field, now_ns)
        self._stepped += 1

    def _comes(self) -> bool:
        """Whether something that moves comes to where the robot is."""
        field = self._field
        return field is not None and field.moves and self._approach.comes(field, self._sample, self._now_ns)

    def _move_guarded(self, twist: Twist, field: ObstacleField, now_ns: int) -> None:
        around, guard = field.table(now_ns), self._guard
        if guard is None:
            self._robot.step(twist, self._dt, around)
            did = self._robot.intervention()
        else:
            sample = self._sample
            self._robot.step(guard.allow(sample.position, sample.velocity, twist, around), self._dt)
            did = guard.did
        self._tally.add(did, now_ns)

    def _fault(self, error: Exception, now_ns: int) -> None:
        """Latch a stop in which the guard moves nothing any more, and is not said to."""
        self.watchdog.fault(f"{type(error).__name__}: {error}", now_ns)
        self._tally.forget()
        self._evades = False

    def _stand_still(self, error: Exception, now_ns: int) -> None:
        """Latch a stop, and still try to brake."""
        self._fault(error, now_ns)
        try:
            self._robot.step(STILL, self._dt)
        except Exception:
            return  # it cannot even be told to stand still; the fault says so to the operator

    def _arm_clearance(self, now_ns: int) -> float | None:
        if self._field is None:
            return None
        try:
            obstacles = self._field.at(now_ns)
            clearance = self._robot.arm_clearance(obstacles)
            if self._statistics.add_arm(clearance):
                self._nearest_part = self._robot.nearest_part(obstacles)
        except Exception as error:
            self._fault(error, now_ns)
            return None
        return clearance

    def _held_by(self, now_ns: int) -> str | msgspec.UnsetType:
        """What the robot says holds it; left out where nothing does."""
        try:
            return self._robot.held_by()[:64] or msgspec.UNSET
        except Exception as error:
            self._fault(error, now_ns)
            return msgspec.UNSET

    def _send_state(self, now_ns: int) -> None:
        watchdog, sample = self.watchdog, self._sample
        sampled_ns = now_ns - to_ns(self._robot.sample_age)
        # first of all: what fails here is in this very state
        arm_clearance, held_by = self._arm_clearance(now_ns), self._held_by(now_ns)
        state = RobotState(
            source=self._name,
            session=self._session,
            seq=self._state_seq,
            t_sent_ns=now_ns,
            echo=self.intake.newest.echo(now_ns),
            t_sample_ns=max(0, sampled_ns),
            position=sample.position,
            velocity=sample.velocity,
            orientation=sample.orientation,
            angular_velocity=sample.angular_velocity,
            joints=sample.joints,
            applied_session=watchdog.applied_session,
            applied_seq=watchdog.applied_seq,
            applied_for_ns=max(0, sampled_ns - watchdog.applied_ns) if watchdog.applied_session else 0,
            mode=watchdog.mode,
            reason=watchdog.reason,
            holder=watchdog.lease.holder,
            holder_name=watchdog.lease.holder_name,
            lease_end=watchdog.lease.end,
            waiting=watchdog.lease.waiting(now_ns),
            clearance=self._clearance,
            min_clearance=self._statistics.min_clearance,
            arm_clearance=arm_clearance,
            refused=self.intake.refused(),
            received=self.intake.arrived,
            stops=watchdog.stops,
            held_by=held_by,
            guard=self._tally.take() or msgspec.UNSET,
            evades=True if self._evades else msgspec.UNSET,
        )
        self._state_seq += 1
        self._link.send(Packet(self._state_key, encode(state)))

    def _send_scene_if_due(self, now_ns: int) -> None:
        # A new holder is a change as well: it must not wait a second before it knows what to avoid.
        holder = self.watchdog.lease.holder
        changed = self._scene_changed or holder != self._shown_holder or self.scene_intake.due(now_ns)
        if not self._scene_due.due(now_ns) and not changed:
            return
        self._scene_changed, self._shown_holder = False, holder
        self.scene_intake.said(now_ns)
        scene = Scene(
            source=self._name,
            session=self._session,
            seq=self._scene_seq,
            t_sent_ns=now_ns,
            t_sample_ns=now_ns,
            obstacles=self._field.at(now_ns) if self._field is not None else self._obstacles,
            targets=self._targets,
            revision=self.scene_intake.revision or msgspec.UNSET,
            answers=self.scene_intake.answers or msgspec.UNSET,
        )
        self._link.send(Packet(scene_key(self._name), encode(scene)))
        self._link.send(Packet(description_key(self._name), encode(self._description(now_ns))))
        self._scene_seq += 1

    def _description(self, now_ns: int) -> RobotDescription:
        settings, safety = self._settings, self._safety
        return RobotDescription(
            source=self._name,
            session=self._session,
            seq=self._scene_seq,
            t_sent_ns=now_ns,
            kind=settings.kind,
            model=self._robot.model,
            joint_names=self._robot.joint_names,
            lag=settings.lag,
            radius=settings.radius,
            rate_hz=settings.rate_hz,
            state_rate_hz=settings.state_rate_hz,
            max_speed=safety.max_speed,
            max_angular_speed=safety.max_angular_speed,
            max_age=safety.max_age,
            command_timeout=safety.command_timeout,
        )


def _finite(sample: RobotSample) -> bool:
    return math.isfinite(
        sum(
            (
                *sample.position,
                *sample.velocity,
                *sample.orientation,
                *sample.joints,
                *sample.angular_velocity,
            )
        )
    )
