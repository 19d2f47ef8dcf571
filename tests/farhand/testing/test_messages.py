"""The builders: valid on the wire as they are, and every field can be said otherwise."""

import pytest

from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.scene import Obstacle
from farhand.common.shapes.box import Box
from farhand.common.shapes.sphere import Sphere
from farhand.testing import (
    OPERATOR_SESSION,
    ROBOT_SESSION,
    command,
    description,
    echo_of,
    obstacle,
    report,
    scene,
    state,
)


@pytest.mark.parametrize("build", [state, scene, description, command, report])
@pytest.mark.parametrize("seq", [0, 1, 1000])
def test_what_is_built_passes_the_wire(build, seq):
    message = build(seq)
    assert Decoder(type(message)).decode_or_raise(encode(message)) == message
    assert message.seq == seq


@pytest.mark.parametrize("build", [state, scene, description, command, report])
def test_every_field_can_be_said_and_no_other(build):
    usual = build()
    assert build(source="x", session=5, t_sent_ns=3).source == "x"
    assert build(session=5).session == 5
    assert build(3, t_sent_ns=3).t_sent_ns == 3
    for field in usual.__struct_fields__:
        if field not in ("seq", "tick", "mode"):
            assert getattr(build(**{field: getattr(usual, field)}), field) == getattr(usual, field)
    with pytest.raises(TypeError, match="thrust"):
        build(thrust=1.0)


@pytest.mark.parametrize("build", [state, scene, description, command, report])
def test_stamps_follow_the_sequence_number(build):
    stamps = [build(seq).t_sent_ns for seq in range(4)]
    assert stamps[0] < stamps[1] < stamps[2] < stamps[3]


def test_a_state_is_sampled_when_it_is_sent_unless_said_otherwise():
    assert state(t_sent_ns=70).t_sample_ns == 70
    assert scene(t_sent_ns=70).t_sample_ns == 70
    assert state(t_sent_ns=70, t_sample_ns=60).t_sample_ns == 60


def test_who_has_control_has_a_name():
    assert (state().holder, state().holder_name) == (OPERATOR_SESSION, "operator")
    assert (state(holder=0).holder, state(holder=0).holder_name) == (0, "")
    assert state(holder=3, holder_name="eve").holder_name == "eve"


def test_only_run_moves():
    assert command(1).velocity != (0.0, 0.0, 0.0)
    for mode in ("hold", "estop", "acknowledge", "release"):
        assert command(1, mode).velocity == (0.0, 0.0, 0.0)
        assert command(1, mode).mode == mode


def test_an_echo_is_that_of_the_message_it_answers():
    seen = state(4, t_sent_ns=50)
    assert command(1, echo=echo_of(seen, hold_ns=3)).echo == echo_of(seen, 3)
    assert (echo_of(seen).session, echo_of(seen).seq, echo_of(seen, 3).hold_ns) == (ROBOT_SESSION, 4, 3)
    assert echo_of(seen).t_sent_ns == 50


def test_an_obstacle_is_a_ball_ahead_unless_it_is_said_otherwise():
    assert obstacle() == Obstacle("ball", (1.0, 0.0, 0.0), 0.1)
    assert obstacle("crate", shape=Box((0.1, 0.2, 0.3))).position == (1.0, 0.0, 0.0)
    cart = obstacle("cart", path=((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), speed=0.1, acceleration=1.0)
    assert (cart.shape, cart.position) == (Sphere(0.1), (0.0, 0.0, 0.0))


def test_a_scene_holds_its_obstacles_in_order():
    ball, box = Obstacle("ball", (1.0, 0.0, 0.0), 0.1), Obstacle("box", (2.0, 0.0, 0.0), 0.1)
    assert scene(0, ball, box).obstacles == (ball, box)
    assert scene(targets=((1.0, 0.0, 0.0),)).targets == ((1.0, 0.0, 0.0),)
