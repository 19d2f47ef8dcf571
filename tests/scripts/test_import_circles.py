"""The check of `make check` for circles of imports."""

import importlib.util

from tests.installed import ROOT


def circles(arrows):
    spec = importlib.util.spec_from_file_location("import_circles", ROOT / "scripts" / "import_circles.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.circles(arrows)


def test_a_way_down_is_no_circle_and_a_way_back_is_one():
    assert circles({"a": ["b", "c"], "b": ["c"], "c": []}) == []
    assert circles({"a": ["b"], "b": ["c"], "c": ["a"], "d": ["a"]}) == [["a", "b", "c"]]
    assert circles({"x": ["y"], "y": ["x"], "a": ["b"], "b": ["a", "x"]}) == [["x", "y"], ["a", "b"]]
