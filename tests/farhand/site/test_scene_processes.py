"""`farhand scene` with real programs: straight through the emulator, through an operator's program, while it drives."""

import json

import pytest

from farhand.cli import run
from farhand.common.link.ports import free_ports
from farhand.common.messages.base import Echo
from farhand.common.messages.codec import encode
from farhand.common.messages.keys import scene_request_key
from farhand.common.messages.scene_request import SceneRequest
from farhand.testing import Programs, Witness, short_task

FAR = [(50.0, 0.0, 0.5)]
OBSTACLES = '[[obstacles]]\nid = "ball"\nposition = [20.0, 3.0, 0.5]\nradius = 0.1\n'


def ids(witness):
    return [] if witness.scene is None else [o.id for o in witness.scene.obstacles]


@pytest.mark.realtime
def test_a_scene_is_changed_while_it_is_driven_by_every_way_and_a_replay_changes_nothing(tmp_path, capsys):
    up, down, reports = (f"tcp/127.0.0.1:{port}" for port in free_ports(3))
    task = ("--scenario", short_task(tmp_path, FAR, OBSTACLES), "--robot", "r")
    at = ("--robot", "r", "--connect", up)
    with Programs() as programs:
        programs.start("netem", "--network", "uniform:10,30", "--listen-operator", up, "--listen-robot", down)
        robot = programs.start("robot", *task, "--connect", down)
        operator = programs.start("operator", *task, "--connect", up, "--report", reports)
        witness = Witness(up)
        try:
            witness.wait_until(lambda s: s.mode == "run" and s.velocity[0] > 0.1)
            post = ["--id", "post", "--shape", "box", "--at", "30,4,0.5", "--size", "0.1,0.1,0.2"]
            assert run(["scene", "add", *post, *at]) == 0
            assert "r: scene revision 1, 2 obstacles: ball, post" in capsys.readouterr().out
            robot.wait_for("scene: revision 1 by ")
            operator.wait_for("the scene was changed (revision 1): post came")
            assert run(["scene", "remove", "ball", "--robot", "r", "--connect", reports]) == 0
            assert "scene revision 2, 1 obstacles: post" in capsys.readouterr().out
            assert run(["scene", "list", *at, "--json"]) == 0
            told = json.loads(capsys.readouterr().out)
            assert (told["revision"], [o["id"] for o in told["obstacles"]]) == (2, ["post"])
            # on the robot: refused with part and obstacle, and nothing changes
            position = witness.states[-1].position
            here = ",".join(f"{x:g}" for x in position)
            assert run(["scene", "add", "--id", "bump", "--at", here, "--size", "0.3", *at]) == 1
            assert "tool is " in (said := capsys.readouterr().err)
            assert "obstacle 'bump'" in said
            # what was asked once is asked again by somebody who recorded it
            state = witness.states[-1]
            old = SceneRequest(source="eve", session=5, seq=0, t_sent_ns=0, deed="remove", base=1, gone=("post",),
                               echo=Echo(state.session, state.seq, state.t_sent_ns, 0))  # fmt: skip
            witness.session.put(scene_request_key("r"), encode(old))
            robot.wait_for("refused to eve: the scene is at revision 2, this was asked of 1")
            assert ids(witness) == ["post"]
            assert witness.wait_until(lambda s: s.velocity[0] > 0.1).mode == "run"
        finally:
            witness.close()


@pytest.mark.realtime
def test_nobody_there_is_no_change(capsys):
    assert run(["scene", "remove", "x", "--connect", f"tcp/127.0.0.1:{free_ports(1)[0]}"]) == 1
    assert "NOT CHANGED: nothing is heard of robot 'ur5'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["add"], "give a FILE, or one obstacle by --id"),
        (["add", "--id", "a", "--at", "1,2", "--size", "1"], "--at '1,2': expected 3 numbers"),
        (["add", "--id", "a", "--at", "1,2,3"], "--size '': expected a number, radius"),
        (
            ["add", "--id", "a", "--at", "1,2,3", "--size", "0"],
            "obstacles[0].shape.radius: expected a number (m) > 0",
        ),
        (["add", "--id", "a", "--at", "1,2,nan", "--size", "1"], "must be a finite number"),
        (["add", "--at", "1,2,3", "--size", "1"], "--id: an obstacle needs a name"),
        (
            ["add", "--id", "a", "--shape", "cone", "--at", "1,2,3"],
            "--shape 'cone': expected sphere, capsule",
        ),
        (
            ["add", "--id", "a", "--shape", "plane", "--at", "1,2,3", "--size", "1"],
            "--size: a plane has none",
        ),
        (["set", "nothing.toml"], "nothing.toml"),
        (["list", "--robot", "a/b"], "a robot's name is 1 to 32 letters"),
    ],
)
def test_bad_input_is_one_line_and_code_2(words, said, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert run(["scene", *words]) == 2
    err = capsys.readouterr().err
    assert said in err
    assert len(err.strip().splitlines()) == 1


def test_a_file_that_says_nothing_of_obstacles_takes_none_away(tmp_path, capsys):
    path = tmp_path / "other.toml"
    path.write_text('[[obstacle]]\nid = "typo"\n')
    assert run(["scene", "set", str(path)]) == 2
    assert "has no [[obstacles]]; to have none at all: obstacles = []" in capsys.readouterr().err
