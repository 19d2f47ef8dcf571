"""What a hostile client does, which knows more than it should: both sides' newest messages and sessions."""

from collections.abc import Callable
from typing import Any

import msgspec

from farhand.common.link.link import Packet
from farhand.common.messages.base import SCHEMA, Echo
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.keys import command_key, scene_key, state_key
from farhand.common.messages.scene import Scene
from farhand.trials.errors.world import World

FOREIGN, OTHER_ROBOT = 123_456_789, 987_654_321
FAST = (0.9, 0.0, 0.9)
"""m/s: twice as fast as the lawful operator ever drives."""
EVERY_NS = 10_000_000
"""A hostile client sends so often."""
Strike = Callable[[World, int], None]
"""What a hostile client does at an instant (ns)."""


def _forged(world: World, now_ns: int, **fields: Any) -> bytes:
    """A command as the newest lawful one, built on the newest state, but for some fields."""
    newest, state = world.lawful[-1][1], world.states[-1][1]
    echo = Echo(world.session, state.seq, state.t_sent_ns, 1_000_000)
    made: dict[str, Any] = {
        "mode": "run", "velocity": FAST, "plan": (FAST,) * 9, "plan_angular": (), "echo": echo, "t_sent_ns": now_ns
    }  # fmt: skip
    return encode(msgspec.structs.replace(newest, **(made | fields)))


def _foreign(world: World, now_ns: int, **fields: Any) -> bytes:
    """The same of a session of its own, numbered by time."""
    made: dict[str, Any] = {"session": FOREIGN, "source": "mallory", "seq": now_ns // EVERY_NS}
    return _forged(world, now_ns, **(made | fields))


def _flipped(world: World, payload: bytes) -> bytes:
    bits = bytearray(payload)
    for _ in range(1 + int(world.rng.integers(8))):
        place = int(world.rng.integers(8 * len(bits)))
        bits[place // 8] ^= 1 << (place % 8)
    return bytes(bits)


def _any(world: World, kept: list[Any]) -> Any:
    return kept[int(world.rng.integers(len(kept)))]


def flip_commands(world: World, now_ns: int) -> None:
    """Newest command again, bits flipped."""
    world.to_robot(_flipped(world, world.lawful[-1][0]), now_ns)


def flip_states(world: World, now_ns: int) -> None:
    """The newest state again, bits flipped."""
    world.to_operator(_flipped(world, world.states[-1][0]), now_ns)


def garbage(world: World, now_ns: int) -> None:
    """Random bytes at both ends."""
    world.to_robot(world.rng.bytes(int(world.rng.integers(1, 600))), now_ns)
    world.to_operator(world.rng.bytes(int(world.rng.integers(1, 600))), now_ns)


def schema(world: World, now_ns: int) -> None:
    """A command of the version before or after."""
    other = SCHEMA + (1 if world.rng.random() < 0.5 else -1)
    world.to_robot(_forged(world, now_ns, schema=other, seq=world.lawful[-1][1].seq + 1), now_ns)


def repeat_commands(world: World, now_ns: int) -> None:
    """Any earlier command again."""
    world.to_robot(_any(world, world.lawful)[0], now_ns)


def repeat_states(world: World, now_ns: int) -> None:
    """Any earlier state, and any scene or description, again."""
    world.to_operator(_any(world, world.states)[0], now_ns)
    key, payload = _any(world, world.scenes)
    world.to_operator(payload, now_ns, key)


def shuffling(world: World) -> Callable[[Packet, int], None]:
    """Packets for the robot wait until there are four, and come in any order."""
    waiting: list[Packet] = []

    def take(packet: Packet, now_ns: int) -> None:
        waiting.append(packet)
        if len(waiting) >= 4:
            for place in world.rng.permutation(len(waiting)):
                world.at_robot(waiting[place], now_ns)
            waiting.clear()

    return take


def holding_back(world: World) -> Callable[[Packet, int], None]:
    """Each packet for the robot comes 1.2 s late, by whom nobody knows."""

    def take(packet: Packet, now_ns: int) -> None:
        world.at(now_ns + 1_200_000_000, lambda late_ns: world.at_robot(packet, late_ns))

    return take


def insert(**fields: Any) -> Strike:
    """Commands of a session of its own, with these fields."""
    return lambda world, now_ns: world.to_robot(_foreign(world, now_ns, **fields), now_ns)


def masquerade(ahead: int, **fields: Any) -> Strike:
    """Commands of the lawful session, numbered so far ahead, with these fields."""

    def strike(world: World, now_ns: int) -> None:
        seq = max(0, world.lawful[-1][1].seq + ahead)
        world.to_robot(_forged(world, now_ns, seq=seq, **fields), now_ns)

    return strike


def stale_echo(world: World, now_ns: int) -> None:
    """A command of the lawful session that is built on an old state."""
    old = next(
        (s for _, s in reversed(world.states) if now_ns - s.t_sent_ns > 1_100_000_000), world.states[0][1]
    )
    echo = Echo(world.session, old.seq, old.t_sent_ns, 1_000_000)
    world.to_robot(_forged(world, now_ns, seq=world.lawful[-1][1].seq + 1, echo=echo), now_ns)


def _state(world: World, now_ns: int, **fields: Any) -> bytes:
    """A state that says that the robot is a metre from where it is."""
    newest = world.states[-1][1]
    x, y, z = newest.position
    made: dict[str, Any] = {"position": (x - 1.0, y, z + 1.0), "seq": newest.seq + 1}
    return encode(msgspec.structs.replace(newest, **(made | fields)))


def foreign_states(world: World, now_ns: int) -> None:
    """States of another session."""
    world.to_operator(_state(world, now_ns, session=OTHER_ROBOT), now_ns)


def forged_states(world: World, now_ns: int) -> None:
    """States of the robot's own session."""
    world.to_operator(_state(world, now_ns), now_ns)


def empty_scenes(world: World, now_ns: int) -> None:
    """Scenes of the robot's own session, newer than its own, that show no obstacle."""
    key, payload = next(each for each in reversed(world.scenes) if each[0] == scene_key(world.name))
    newest = Decoder(Scene).decode_or_raise(payload)
    made: dict[str, Any] = {"obstacles": (), "seq": newest.seq + 1}
    world.to_operator(encode(msgspec.structs.replace(newest, **made)), now_ns, key)


def other_key(world: World, now_ns: int) -> None:
    """Under the keys of another robot."""
    world.to_robot(_forged(world, now_ns, seq=world.lawful[-1][1].seq + 1), now_ns, command_key("other"))
    world.to_operator(_state(world, now_ns), now_ns, state_key("other"))


def others_command(world: World, now_ns: int) -> None:
    """Of another robot's lawful operator: its session, and built on a state of that other robot."""
    echo = Echo(OTHER_ROBOT, 5, max(0, now_ns - 20_000_000), 1_000_000)
    world.to_robot(_foreign(world, now_ns, echo=echo), now_ns)


def own_operators_for_other(world: World, now_ns: int) -> None:
    """Of this robot's own operator, meant for another robot that it drives as well."""
    echo = Echo(OTHER_ROBOT, 5, max(0, now_ns - 20_000_000), 1_000_000)
    world.to_robot(_forged(world, now_ns, seq=world.lawful[-1][1].seq + 1, echo=echo), now_ns)
