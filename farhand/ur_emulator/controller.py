"""The emulated controller: modes of robot and safety, program, watchdog, registers; told its cycles one by one."""

from collections.abc import Callable
from enum import IntEnum

import numpy as np

from farhand.common.geometry import Array
from farhand.robot_side.arm.chain import ArmChain
from farhand.robot_side.arm.model import ArmModel
from farhand.ur_emulator.motion import BRAKE_OF_STOP, Motion
from farhand.ur_emulator.physics import Physics
from farhand.ur_emulator.program import Program
from farhand.ur_emulator.registers import Registers

UNLOCK_AFTER = 5.0
"""s from a protective stop until the controller lets it be unlocked."""
POWERING, RELEASING, BOOTING = 1.0, 1.0, 3.0
"""s that power on, the release of the brakes and a restart take."""
DEVIATION = 0.2
"""rad between set point and joint that trip a protective stop."""
STILL = 1e-4
"""rad/s, below which the arm stands."""


class RobotMode(IntEnum):
    """As RTDE and the dashboard number them."""

    DISCONNECTED = 0
    BOOTING = 2
    POWER_OFF = 3
    POWER_ON = 4
    IDLE = 5
    BACKDRIVE = 6
    RUNNING = 7


class SafetyMode(IntEnum):
    """As RTDE numbers them."""

    NORMAL = 1
    REDUCED = 2
    PROTECTIVE_STOP = 3
    RECOVERY = 4
    SAFEGUARD_STOP = 5
    SYSTEM_EMERGENCY_STOP = 6
    ROBOT_EMERGENCY_STOP = 7
    VIOLATION = 8
    FAULT = 9


class Runtime(IntEnum):
    """State of the program, as RTDE numbers it."""

    STOPPING = 0
    STOPPED = 1
    PLAYING = 2
    PAUSING = 3
    PAUSED = 4
    RESUMING = 5


class Watchdog:
    """Of one input register: which, how long it may stay away (s), when it came last (s)."""

    def __init__(self, register: str, longest: float, now: float) -> None:
        self.register, self.longest, self.heard = register, longest, now


class Controller:
    """An arm and what decides over it. Knows no socket and no clock.

    Args:
        arm: which.
        q: (n,) where it stands (rad).
        rate_hz: cycles a second.
        version: of its software, such as (5, 12, 0, 1101319).
        say: takes a line for people.

    Attributes:
        now: time since its start (s).
        remote: whether it may be controlled from elsewhere.
        slider: of the speed, 0 to 1.
        scaling: speed scaling in force, 0 to 1.
        payload, payload_cog: (kg), (m).
        tcp: offset of the tool, x, y, z (m), rotation vector (rad).
        program: that runs or is paused; None: none.
        listeners: called when a program ends, so that its sockets are closed.
    """

    def __init__(
        self,
        arm: ArmModel,
        q: Array,
        rate_hz: float,
        version: tuple[int, int, int, int],
        say: Callable[[str], None],
    ) -> None:
        self.arm, self.rate_hz, self.step_time, self.version = arm, rate_hz, 1.0 / rate_hz, version
        self.say = say
        self.now = 0.0
        self.remote, self.slider, self.scaling = True, 1.0, 1.0
        self.payload, self.payload_cog = 0.0, [0.0, 0.0, 0.0]
        self.tcp = [0.0] * 6
        self.registers = Registers()
        self.physics, self.motion = Physics(arm, q), Motion(arm, q)
        self.chain = ArmChain(arm)
        self.robot_mode, self.safety_mode = RobotMode.RUNNING, SafetyMode.NORMAL
        self.runtime = Runtime.STOPPED
        self.program: Program | None = None
        self.listeners: list[Callable[[], None]] = []
        self.watchdog: Watchdog | None = None
        self._secondary: list[Program] = []
        self._stopped_at = 0.0  # the last protective stop
        self._next_mode: tuple[float, RobotMode] | None = None

    @property
    def stopped_by_safety(self) -> bool:
        """Whether the safety system keeps the arm standing."""
        return self.safety_mode not in (SafetyMode.NORMAL, SafetyMode.REDUCED)

    @property
    def moves(self) -> bool:
        """Whether any joint moves."""
        return bool(np.abs(self.physics.qd).max() > STILL)

    def cycle(self) -> None:
        """One period."""
        self.now += self.step_time
        self._change_mode()
        self._watch()
        if self.program is not None and self.runtime == Runtime.PLAYING:
            self.program.cycle()
            if not self.program.running:
                self._finish(self.program)
        for secondary in self._secondary:
            secondary.cycle()
        self._secondary = [each for each in self._secondary if each.running]
        self._move()

    def start_program(self, program: Program) -> None:
        """Run a program in place of the one that runs."""
        self.end_program()
        self.program, self.runtime = program, Runtime.PLAYING

    def run_secondary(self, program: Program) -> None:
        """Run a secondary program beside the one that runs; it may not move the arm."""
        self._secondary.append(program)

    def end_program(self) -> None:
        """Stop the program, if there is one; the arm brakes."""
        if self.program is not None:
            self.program.end()
            self._finish(self.program)

    def pause(self) -> bool:
        """Pause the program; the arm brakes. Whether there was one that ran."""
        if self.runtime != Runtime.PLAYING:
            return False
        self.runtime = Runtime.PAUSED
        self.motion.stop(BRAKE_OF_STOP)
        return True

    def play(self) -> bool:
        """Go on with a paused program; whether there is one and nothing forbids it."""
        if self.runtime != Runtime.PAUSED or not self.may_move():
            return False
        self.runtime = Runtime.PLAYING
        return True

    def may_move(self) -> bool:
        """Whether a program may run at all."""
        return self.robot_mode == RobotMode.RUNNING and not self.stopped_by_safety

    def protective_stop(self, why: str) -> None:
        """Stop, and pause the program."""
        if self.stopped_by_safety:
            return
        self.say(f"protective stop: {why}")
        self.safety_mode, self._stopped_at = SafetyMode.PROTECTIVE_STOP, self.now
        self.pause()
        self.motion.stop(BRAKE_OF_STOP)

    def unlock_protective_stop(self) -> str:
        """Clear a protective stop; what is said of it."""
        if self.safety_mode != SafetyMode.PROTECTIVE_STOP:
            return "Protective stop releasing"
        if self.now - self._stopped_at < UNLOCK_AFTER:
            return (
                "Cannot unlock protective stop until 5s after occurrence. "
                "Always inspect cause of protective stop before unlocking"
            )
        self.safety_mode = SafetyMode.NORMAL
        self.say("protective stop unlocked")
        return "Protective stop releasing"

    def safeguard(self, open_: bool) -> None:
        """A safeguard's contact opens, or closes again; a paused program goes on only when it is played."""
        if open_ and not self.stopped_by_safety:
            self.safety_mode = SafetyMode.SAFEGUARD_STOP
            self.pause()
            self.motion.stop(BRAKE_OF_STOP)
        elif not open_ and self.safety_mode == SafetyMode.SAFEGUARD_STOP:
            self.safety_mode = SafetyMode.NORMAL

    def emergency_stop(self, pressed: bool) -> None:
        """The red button is pressed, or let go: afterwards the arm is without power."""
        if pressed:
            self.safety_mode = SafetyMode.ROBOT_EMERGENCY_STOP
            self.end_program()
            self.motion.stop(BRAKE_OF_STOP)
        elif self.safety_mode == SafetyMode.ROBOT_EMERGENCY_STOP:
            self.safety_mode = SafetyMode.NORMAL
            self._power_off()

    def power_on(self) -> None:
        """Give the arm power; its brakes stay closed."""
        if self.robot_mode == RobotMode.POWER_OFF and not self.stopped_by_safety:
            self.robot_mode, self._next_mode = RobotMode.POWER_ON, (self.now + POWERING, RobotMode.IDLE)

    def release_brakes(self) -> None:
        """Give power if there is none, and open the brakes."""
        self.power_on()
        if self.robot_mode in (RobotMode.POWER_ON, RobotMode.IDLE):
            wait = RELEASING + (POWERING if self.robot_mode == RobotMode.POWER_ON else 0.0)
            self._next_mode = self.now + wait, RobotMode.RUNNING

    def power_off(self) -> None:
        """Take the power away; the brakes close."""
        self.end_program()
        self._power_off()

    def boot(self) -> None:
        """Start anew, as after a loss of mains: nothing of the program or the registers stays."""
        self.end_program()
        self.safety_mode, self.robot_mode = SafetyMode.NORMAL, RobotMode.BOOTING
        self.registers = Registers()
        self._next_mode = self.now + BOOTING, RobotMode.POWER_OFF
        self._stand()

    def freedrive(self, on: bool) -> None:
        """Somebody holds the button behind the pendant, or lets it go: the program is paused."""
        if on and self.robot_mode == RobotMode.RUNNING:
            self.pause()
            self.robot_mode = RobotMode.BACKDRIVE
        elif not on and self.robot_mode == RobotMode.BACKDRIVE:
            self.robot_mode = RobotMode.RUNNING

    def set_slider(self, fraction: float) -> None:
        """Move the speed slider; a speed that is still asked for when it leaves 0 trips a stop."""
        if self.slider == 0.0 < fraction and self.motion.asked.any():
            self.protective_stop("the speed slider left 0 under a command")
        self.slider = fraction

    def set_watchdog(self, register: str, min_frequency: float) -> None:
        """From now on `register` comes that often, or it is a protective stop; 0 disarms nothing."""
        if min_frequency > 0.0:
            self.watchdog = Watchdog(register, 1.0 / min_frequency, self.now)

    def heard(self, names: tuple[str, ...]) -> None:
        """A client has sent these inputs."""
        if self.watchdog is not None and self.watchdog.register in names:
            self.watchdog.heard = self.now

    def close(self) -> None:
        """Give the physics back."""
        self.end_program()
        self.physics.close()

    def _power_off(self) -> None:
        self.robot_mode, self._next_mode = RobotMode.POWER_OFF, None
        self._stand()

    def _stand(self) -> None:
        self.motion.place(self.physics.q)

    def _change_mode(self) -> None:
        if self._next_mode is not None and self.now >= self._next_mode[0]:
            self.robot_mode, self._next_mode = self._next_mode[1], None

    def _watch(self) -> None:
        dog = self.watchdog
        if dog is None or self.runtime != Runtime.PLAYING:
            return
        if self.now - dog.heard > dog.longest:
            self.watchdog = None
            self.protective_stop(f"{dog.register} stayed away for {dog.longest:.3f} s (watchdog)")

    def _finish(self, program: Program) -> None:
        if program.error:
            self.say(f"program ended: {program.error}")
        self.program, self.runtime, self.watchdog = None, Runtime.STOPPED, None
        if not self.motion.stands:
            self.motion.stop(BRAKE_OF_STOP)
        for listener in self.listeners:
            listener()

    def _move(self) -> None:
        rate = self.step_time / 0.1  # the scaling follows the slider within 0.1 s
        self.scaling += max(-rate, min(rate, self.slider - self.scaling))
        powered = self.robot_mode in (RobotMode.RUNNING, RobotMode.BACKDRIVE)
        if powered:
            self.motion.step(self.step_time, self.scaling if self.may_move() else 1.0)
        elif not self.motion.stands:
            self._stand()
        self.physics.step(self.motion.q, self.motion.qd, self.step_time)
        if powered and float(np.abs(self.motion.q - self.physics.q).max()) > DEVIATION:
            self.protective_stop("a joint is too far from where it shall be")
