from farhand.operator_side.steering.device import SteeringInput
from farhand.testing import ScriptedDevice, scene, state, view

SECOND = 1_000_000_000
OFF = SteeringInput()


def test_it_wants_what_it_is_told():
    device = ScriptedDevice()
    assert device.read(view()) == SteeringInput((0.2, 0.0, 0.0), engaged=True)
    device.wants = OFF
    assert device.read(view()) == OFF
    device.wants = (0.0, 0.1, 0.0)
    assert device.read(view()) == SteeringInput((0.0, 0.1, 0.0), engaged=True)


def test_a_script_goes_by_the_time_since_the_first_reading():
    stop = SteeringInput(engaged=True, estop=True)
    device = ScriptedDevice((0.1, 0.0, 0.0), script=[(1.0, OFF), (2.0, (0.0, 0.3, 0.0)), (2.5, stop)])
    start = 77 * SECOND
    wanted = [device.read(view(start + k * SECOND // 2)) for k in range(7)]
    moving, turned = SteeringInput((0.1, 0.0, 0.0), True), SteeringInput((0.0, 0.3, 0.0), True)
    assert wanted == [moving, moving, OFF, OFF, turned, stop, stop]


def test_it_keeps_what_it_was_read_with():
    device = ScriptedDevice()
    device.read(view(5, state(3), scene(2)))
    (seen,) = device.looked
    assert (seen.state.seq, seen.scene.seq, seen.now_ns) == (3, 2, 5)
