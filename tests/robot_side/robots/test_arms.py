"""Arms by name and by file, with what they hold: as data, and driven in PyBullet."""

import itertools

import numpy as np
import pytest

from farhand.common.errors import ScenarioError
from farhand.common.geometry import Twist
from farhand.common.messages.scene import Obstacle
from farhand.robot_side.arm.catalogue import ARMS
from farhand.robot_side.arm.description.variants import first_link
from farhand.robot_side.arm.model import model
from farhand.robot_side.robots import pybullet_arm
from farhand.robot_side.robots.arms import chosen_arm, fit_files, model_from_files
from farhand.robot_side.robots.bullet_obstacles import BulletObstacles
from farhand.robot_side.robots.registry import make_robot
from farhand.robot_side.robots.settings import RobotSettings, ToolSettings
from farhand.runs.scenario import load_scenario, parse_scenario, replace_settings
from tests.robot_side.arm.own_arm import HOME, SRDF, urdf

PANDA, UR5 = load_scenario("panda-obstacle"), load_scenario("ur5-obstacle")
DT = 0.002
STARTS = {
    "ur3": (0.27, 0.0, 0.2),
    "ur5": (0.45, 0.0, 0.3),
    "ur10": (0.7, 0.0, 0.4),
    "ur3e": (0.27, 0.0, 0.2),
    "ur5e": (0.45, 0.0, 0.3),
    "panda": (0.45, 0.0, 0.35),
}


@pytest.fixture(params=list(ARMS))
def robot(request):
    start = list(STARTS[request.param])
    robot = make_robot(
        replace_settings(
            PANDA, {"robot.model": request.param, "start": start, "targets": [start], "obstacles": []}
        )
    )
    yield robot
    robot.close()


@pytest.fixture
def files(tmp_path):
    (tmp_path / "mine.urdf").write_text(urdf())
    (tmp_path / "mine.srdf").write_text(SRDF)
    return tmp_path / "mine.urdf", tmp_path / "mine.srdf"


@pytest.fixture
def whole(monkeypatch):
    monkeypatch.setattr(pybullet_arm, "massive_text", lambda text: text)


def test_physics_and_arrays_agree(whole, robot):
    bullet, client, arm = robot._bullet, robot._client, robot.arm
    rng = np.random.default_rng(1)
    for _ in range(5):
        q = rng.uniform(arm.lower, arm.upper)
        for index, angle in zip(robot.joint_indices, q, strict=True):
            bullet.resetJointState(robot.body, index, angle, physicsClientId=client)
        link = robot.link_indices[arm.tool_frame]
        state = bullet.getLinkState(robot.body, link, computeForwardKinematics=True, physicsClientId=client)
        R, p = arm.tool_pose(q)
        assert np.allclose(state[4], p, atol=1e-6)
        assert np.allclose(np.array(bullet.getMatrixFromQuaternion(state[5])).reshape(3, 3), R, atol=1e-5)


@pytest.mark.parametrize("robot", ["ur3e", "ur5e"], indirect=True)
@pytest.mark.parametrize(
    ("one", "other", "joints"),
    [("base_link", "upper_arm_link", (0, 1)), ("wrist_1_link", "wrist_3_link", (4, 5))],
)
def test_pairs_of_the_e_series_that_are_not_kept_apart_cannot_meet(robot, one, other, joints):
    arm, bullet, client, body = robot.arm, robot._bullet, robot._client, robot.body
    assert frozenset((one, other)) in arm.never_colliding
    links = [robot.link_indices.get(name, -1) for name in (one, other)]
    ways = [np.linspace(max(arm.lower[k], -np.pi - 0.5), min(arm.upper[k], np.pi), 25) for k in joints]
    gaps = []
    for angles in itertools.product(*ways):
        for k, angle in zip(joints, angles, strict=True):
            bullet.resetJointState(body, robot.joint_indices[k], angle, physicsClientId=client)
        bullet.performCollisionDetection(physicsClientId=client)
        gaps += [near[8] for near in bullet.getClosestPoints(body, body, 1.0, *links, physicsClientId=client)]
    assert 0.009 < min(gaps) < 0.02


@pytest.mark.parametrize("scenario", [UR5, PANDA], ids=["ur5", "panda"])
def test_frames_without_mass_or_shape_change_no_bit_of_the_motion(scenario, monkeypatch):
    ways = []
    for text in (pybullet_arm.massive_text, str):
        monkeypatch.setattr(pybullet_arm, "massive_text", text)
        robot = make_robot(scenario)
        way = []
        for k in range(300):
            robot.step(Twist((0.1, 0.001 * k, -0.05)), DT)
            way.append(robot.sample())
        ways.append((robot._bullet.getNumJoints(robot.body, physicsClientId=robot._client), way))
        robot.close()
    (few, lean), (many, full) = ways
    assert few < many
    assert lean == full


@pytest.mark.parametrize(
    ("origin", "foot"),
    [
        ('xyz="0 0 0.0" rpy="0 0 0"', "base_link"),
        ('xyz="0 0 0.1" rpy="0 0 0"', "world"),
        ('xyz="0 0 0" rpy="0 0 1"', "world"),
    ],
)
def test_a_frame_at_the_foot_is_left_out_where_nothing_is_placed_elsewhere_then(origin, foot):
    whole = f"""<robot name="it"><link name="world"/>
      <link name="base_link"><inertial><mass value="1"/></inertial></link>
      <joint name="fast" type="fixed"><parent link="world"/><child link="base_link"/><origin {origin}/></joint>
    </robot>"""
    assert first_link(whole) == "world"
    assert first_link(pybullet_arm.massive_text(whole)) == foot


def test_links_that_are_not_measured_again_could_not_be_the_nearest(robot):
    obstacles = tuple(
        Obstacle(f"o{k}", place, 0.05)
        for k, place in enumerate(((0.5, 0.5, 0.3), (-0.4, 0.3, 0.5), (0.3, -0.5, 0.1), (0.0, 0.0, 1.3)))
    )
    nearest = set()
    for k in range(40):
        q = robot.arm.home + 0.8 * np.sin(0.37 * k * np.arange(1, robot.arm.n + 1))
        robot.place(np.clip(q, robot.arm.lower, robot.arm.upper))
        fresh = BulletObstacles(robot._bullet, robot._client, robot.body, min(robot.joint_indices))
        distance, name, link = fresh.nearest(obstacles)
        fresh.remove()
        assert robot.arm_clearance(obstacles) == distance
        part = robot.nearest_part(obstacles)
        assert part[1] == name
        assert robot.link_indices[part[0]] == link
        nearest.add(link)
    assert len(nearest) > 1


def test_every_arm_rests_without_creeping_and_follows(robot):
    start = np.array(robot.sample().position)
    assert robot.sample().joints == tuple(robot._q)
    for _ in range(1000):
        robot.step(Twist(), DT)
    assert np.linalg.norm(np.array(robot.sample().position) - start) < 5e-6
    velocity, most = (0.0, 0.15, 0.1), robot.arm.max_acceleration * DT
    before = robot._follower.commanded
    for _ in range(300):
        robot.step(Twist(velocity), DT)
        assert np.all(np.abs(robot._follower.commanded - before) <= most + 1e-9)
        before = robot._follower.commanded
    assert robot.sample().velocity == pytest.approx(velocity, abs=1.5e-3)
    moved = np.array(robot.sample().position) - start
    along = np.array(velocity) / np.linalg.norm(velocity)
    assert np.linalg.norm(moved - (moved @ along) * along) < 1e-3
    assert robot.held_by() == ""
    assert robot.control.failures == 0


def test_a_stretched_panda_says_so():
    robot = make_robot(replace_settings(PANDA, {"obstacles": []}))
    for _ in range(1500):
        robot.step(Twist((0.3, 0.0, 0.0)), DT)
    held = robot.held_by()
    robot.close()
    assert held == "the edge of its reach"


def test_what_an_arm_holds_is_measured_kept_apart_and_named():
    obstacle = {"id": "under", "position": [0.45, -0.35, 0.05], "radius": 0.05}
    tool = {"radius": 0.02, "end": [0.0, 0.0, 0.15]}
    at = {"obstacles": [obstacle], "targets": [[0.45, -0.35, 0.35]]}
    bare, holding = (
        make_robot(replace_settings(PANDA, at)),
        make_robot(replace_settings(PANDA, {**at, "robot.tool": tool})),
    )
    seen = (Obstacle("under", (0.45, -0.35, 0.05), 0.05),)
    assert bare.arm_clearance(seen) == pytest.approx(0.25 - 0.0089, abs=0.005)  # the fingers' tips
    assert holding.arm_clearance(seen) == pytest.approx(0.35 - 0.05 - 0.05 - 0.15 - 0.02, abs=0.002)
    assert holding.nearest_part(seen) == ("tool", "under")
    capsule = holding.arm.capsules[-1]
    assert (capsule.part, capsule.joint, capsule.radius) == ("tool", 6, 0.02)
    R, p = holding.arm.tool_pose(holding._q)
    assert holding.arm.segments(holding._q)[-1] == pytest.approx(np.array([p, p + 0.15 * R[:, 2]]))
    kept = {holding.arm.capsules[i].part for i, j in holding.arm.self_pairs if j == len(bare.arm.capsules)}
    assert {"panda_link0", "panda_link3"} <= kept
    assert not kept & {"panda_hand", "panda_link7"}
    for _ in range(500):
        holding.step(Twist((0.0, 0.1, 0.0)), DT)
    assert holding.sample().velocity[1] == pytest.approx(0.1, abs=1e-3)
    bare.close()
    holding.close()


def test_a_held_ball_and_a_slanted_rod_make_no_noise(capfd):
    for tool in (
        ToolSettings(radius=0.03),
        ToolSettings(radius=0.01, start=(0.1, 0.0, 0.0), end=(0.0, -0.1, 0.1)),
    ):
        arm = chosen_arm(RobotSettings(kind="ur5", tool=tool))
        scenario = replace_settings(
            load_scenario("ur5-obstacle"), {"robot.tool.radius": tool.radius, "robot.tool.start": list(tool.start),
                                            "robot.tool.end": list(tool.end)}
        )  # fmt: skip
        robot = make_robot(scenario)
        link = robot.link_indices["tool"]
        shape = robot._bullet.getCollisionShapeData(robot.body, link, physicsClientId=robot._client)[0]
        middle = (np.array(tool.start) + np.array(tool.end)) / 2
        assert shape[5] == pytest.approx(middle, abs=1e-9)
        assert len(arm.capsules) == len(model("ur5").capsules) + 1
        robot.close()
    assert capfd.readouterr() == ("", "")


def test_an_arm_by_its_files(files, tmp_path):
    arm = model_from_files(*files)
    assert (arm.name, arm.tool_frame, arm.n) == ("mine", "hand", 6)
    assert arm.home.tolist() == list(HOME)
    assert [capsule.part for capsule in arm.capsules] == [
        *(f"link{i}" for i in range(1, 7)),
        "hand",
        "finger",
    ]
    file = tmp_path / "capsules.toml"
    file.write_text(fit_files(*files, "", None).text("--urdf mine.urdf"))
    again = model_from_files(*files, file)
    assert [c.radius for c in again.capsules] == pytest.approx([c.radius for c in arm.capsules])
    assert again.self_pairs == arm.self_pairs
    # A cylinder is held by a capsule as wide, but for its rim.
    assert arm.capsules[0].radius == pytest.approx(0.045, abs=0.005)


def test_it_is_driven_like_the_others_its_files_lie_beside_the_scenario(files):
    start = model_from_files(*files).tool_pose(np.array(HOME))[1].tolist()
    path = files[0].parent / "mine.toml"
    path.write_text(
        f'name = "mine"\nstart = {start}\ntargets = [{start}]\n'
        '[robot]\nkind = "arm"\nurdf = "mine.urdf"\nsrdf = "mine.srdf"\n'
    )
    robot = make_robot(load_scenario(str(path)))
    assert robot.sample().joints == pytest.approx(HOME, abs=1e-3)
    assert (robot.model, robot.joint_names) == ("mine", tuple(f"j{i}" for i in range(1, 7)))
    for _ in range(200):
        robot.step(Twist((0.0, 0.1, 0.0)), DT)
    assert robot.sample().velocity[1] == pytest.approx(0.1, abs=2e-3)
    robot.close()


TASK = 'name = "x"\nstart = [0.4, 0.0, 0.4]\ntargets = [[0.4, 0.0, 0.4]]\n[robot]\nkind = "arm"\n'


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("", "kind 'arm' needs model, one of ur3, ur5, ur10, ur3e, ur5e, panda, or urdf, a file"),
        ('model = "pandas"', "model 'pandas': no such arm; nearest are panda"),
        ('model = "panda"\nurdf = "a.urdf"', "model and urdf name two arms"),
        ('model = "panda"\nsrdf = "a.srdf"', "srdf: goes with urdf; the Panda's is known"),
        ('model = "panda"\njoints = [0, 0, 0, 0, 0, 0]', "joints: the Panda has 7 joints, not 6"),
        ('model = "panda"\nhome = [0]', "home: the Panda has 7 joints, not 1"),
        ('model = "panda"\n[robot.tool]\nradius = 0', "robot.tool.radius: expected a number > 0"),
        (
            'model = "panda"\n[robot.tool]\nend = [0, 0, 1]',
            "robot.tool: object missing required field `radius`",
        ),
    ],
)
def test_a_scenario_that_names_its_arm_badly_is_refused_at_once(words, said):
    with pytest.raises(ScenarioError) as refused:
        parse_scenario(TASK + words, "mine.toml")
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (
            {"tool": ToolSettings(radius=2.0)},
            "robot.tool: reaches 2.00 m from the tool frame, farther than the Panda",
        ),
        (
            {"home": (0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0)},
            "robot: home: panda_joint4 would stand outside of its",
        ),
    ],
)
def test_what_does_not_fit_the_arm_is_refused(settings, said):
    with pytest.raises(ScenarioError) as refused:
        chosen_arm(RobotSettings(kind="arm", model="panda", **settings))
    assert said in str(refused.value)


def test_files_that_do_not_fit_each_other(files, tmp_path):
    urdf_path, srdf_path = files
    with pytest.raises(ScenarioError, match=r"no home: set robot.home, 6 angles"):
        chosen_arm(RobotSettings(kind="arm", urdf=str(urdf_path), tool_frame="hand"))
    capsules = tmp_path / "other.toml"
    capsules.write_text(
        'overlapping = []\n[[capsules]]\nlink = "lnik1"\na = [0, 0, 0]\nb = [0, 0, 0]\nradius = 0.1\n'
    )
    wrong = RobotSettings(kind="arm", urdf=str(urdf_path), srdf=str(srdf_path), capsules=str(capsules))
    with pytest.raises(ScenarioError, match=r"link 'lnik1': no such link; nearest are link"):
        chosen_arm(wrong)
    capsules.write_text("capsules = []\n")
    with pytest.raises(ScenarioError, match=r"other.toml: capsules: expected a list of length >= 1"):
        chosen_arm(wrong)


def test_a_robot_that_is_no_arm_holds_no_tool():
    with pytest.raises(ScenarioError, match=r"tool: is for an arm, not for kind 'point'"):
        replace_settings(load_scenario("point-obstacle"), {"robot.tool.radius": 0.1})
