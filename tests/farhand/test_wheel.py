"""What users install: one name, that works in an empty folder and breaks nobody else's."""

import json
import zipfile

import pytest

from farhand.testing import short_task


def test_one_name_goes_into_site_packages(installed):
    with zipfile.ZipFile(installed.wheel) as wheel:
        names = wheel.namelist()
    tops = {name.partition("/")[0] for name in names}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"farhand"}
    assert "farhand/scenarios/ur5-obstacle.toml" in names
    assert "farhand/robot_side/arm/models/panda.toml" in names
    assert {"farhand/report/page.css", "farhand/report/turning.js"} <= set(names)
    assert "farhand/py.typed" in names
    for part in ("common", "netem", "operator_side", "robot_side"):
        assert f"farhand/{part}/__init__.py" in names


def test_the_code_is_that_of_the_wheel(installed):
    done = installed.run(
        "-c", "import farhand, farhand.common.seeds as s; print(farhand.__file__, s.__file__)"
    )
    assert done.returncode == 0, done.stderr
    for path in done.stdout.split():
        assert path.startswith(str(installed.packages))


def test_every_public_name_is_there(installed):
    done = installed.run(
        "-c",
        "import farhand\nfor name in farhand.__all__: getattr(farhand, name)\nprint(len(farhand.__all__))",
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 30


def test_simulate_in_an_empty_folder(installed):
    # without the guard, which a new installation would compile for half a minute
    done = installed.farhand(
        "simulate", "--scenario", "point-obstacle", "--network", "constant:50", "--time-limit", "60", "--json",
        "--guard", "off",
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    summary = json.loads(done.stdout.splitlines()[-1])
    assert summary["safe"]
    assert summary["finished"]


def test_a_package_of_the_users_own_called_common_stays_the_users(installed, tmp_path):
    (tmp_path / "common").mkdir()
    (tmp_path / "common" / "__init__.py").write_text("MINE = 1\n")
    (tmp_path / "netem.py").write_text("MINE = 2\n")
    (tmp_path / "test_mine.py").write_text(
        "import pytest\nimport common\nimport netem\n\n\n"
        '@pytest.mark.farhand(scenario="point-obstacle", network="none", time_limit=60)\n'
        "def test_mine(farhand):\n"
        "    assert (common.MINE, netem.MINE) == (1, 2)\n"
        "    farhand.run().check(stops=0)\n"
    )
    (tmp_path / "pytest.ini").write_text("[pytest]\nfilterwarnings = error\npythonpath = .\n")
    done = installed.run("-m", "pytest", "-q", "-p", "no:cacheprovider", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 passed" in done.stdout


@pytest.mark.long
@pytest.mark.realtime
def test_the_demo_in_an_empty_folder(installed, tmp_path):
    task = short_task(tmp_path)
    done = installed.farhand("demo", "--scenario", str(task), "--network", "constant:50", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "SAFE" in done.stdout
    logs = [path.read_text() for path in tmp_path.glob("runs/*/record.log")]
    assert list(tmp_path.glob("runs/*/run.mcap")), logs
