"""What mode the next command has: the operator's half of the safety state machine, one decision a tick.

| situation | command |
|---|---|
| no state or no scene yet | nothing is sent |
| another session holds control | nothing is sent |
| nobody holds control | acknowledge, which asks for it |
| the device's emergency stop | estop |
| the robot is stopped and the operator acknowledges | acknowledge |
| the robot is stopped or estopped | hold |
| the device is not engaged | hold |
| otherwise | run |
"""

from dataclasses import dataclass

from common.messages import CommandMode, RobotState, Scene
from operator_side.steering.device import SteeringInput


@dataclass(frozen=True, slots=True)
class Decision:
    """Attributes:
    mode: of the command; None: send nothing.
    reason: why it is not `run`, empty for `run`.
    """

    mode: CommandMode | None
    reason: str = ""


def decide(
    state: RobotState | None, scene: Scene | None, steering: SteeringInput | None, session: int
) -> Decision:
    """The table above, first match first.

    Args:
        state, scene: newest from the robot, if any.
        steering: what the device wants; None before there is a state and a scene.
        session: this operator's session.
    """
    if steering is not None and steering.estop:
        return Decision("estop", "emergency stop by the operator")
    if state is None:
        return Decision(None, "no state from the robot yet")
    if scene is None or steering is None:
        return Decision(None, "no scene from the robot yet")
    if state.holder not in (0, session):
        return Decision(None, f"another operator holds control (session {state.holder:x})")
    if state.mode in ("stopped", "estop"):
        if steering.acknowledge:
            return Decision("acknowledge", f"acknowledging: {state.reason}")
        return Decision("hold", f"robot {state.mode}: {state.reason}")
    if state.holder == 0:
        return Decision("acknowledge", "asking for control")
    if not steering.engaged:
        return Decision("hold", "device not engaged")
    return Decision("run")
