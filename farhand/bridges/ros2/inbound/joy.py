"""What a joystick's axes and buttons do: those of an Xbox pad under `joy_node`."""

from farhand.operator_side.steering.hand.hand_settings import HandSettings


class JoySettings(HandSettings, frozen=True, kw_only=True):
    """See HandSettings; the names are raw: `axis0`, `button0` and so on, as in sensor_msgs/Joy."""

    x: str = "axis1"
    y: str = "axis0"
    z: str = "axis7"
    roll: str = "axis6"
    pitch: str = "axis4"
    yaw: str = "axis3"
    deadman: str = "button5"
    estop: str = "button1"
    acknowledge: str = "button7"
    faster: str = ""
    slower: str = ""
    turn_frame: str = "button6"
    dead_zone: float = 0.05
