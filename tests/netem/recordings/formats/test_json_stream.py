"""JSON in pieces: the same values as of the whole, little of it held at a time; what is wrong is told from a cut."""

import json

import pytest

from farhand.netem.recordings.formats import json_stream
from farhand.netem.recordings.formats.json_stream import CutOffError, JsonError, JsonStream

VALUE = {"a": [1, 2.5e3, -7, {"b": 'x"y, ]}'}, None, True], "c": {}, "d": [], "e": "ü\n", "f": 123456}


def read(text):
    stream = JsonStream(text.split("\n"))
    return {key: list(stream.items()) if key in ("a", "d") else stream.value() for key in stream.members()}


@pytest.mark.parametrize("piece", [1, 2, 7, 1000])
@pytest.mark.parametrize("indent", [None, 0, 3])
def test_it_is_what_json_makes_of_the_whole(monkeypatch, piece, indent):
    monkeypatch.setattr(json_stream, "PIECE", piece)
    assert read(json.dumps(VALUE, indent=indent)) == VALUE
    assert read("{}") == read(" { }\n\n") == {}


def test_every_cut_is_told_from_what_is_no_json(monkeypatch):
    monkeypatch.setattr(json_stream, "PIECE", 5)
    text = json.dumps(VALUE, indent=1)
    for end in range(len(text)):
        with pytest.raises(CutOffError):
            read(text[:end])


NO_JSON = ["[1]", "{1: 2}", '{"a": [1 2]}', '{"c": tru3}', '{"c": 1} x', '{"c": 1,}', '{"c" 1}', "x"]


@pytest.mark.parametrize("text", NO_JSON)
def test_what_is_no_json_is_an_error_and_no_cut(text):
    with pytest.raises(JsonError) as found:
        read(text)
    assert not isinstance(found.value, CutOffError)


def test_nesting_has_an_end():
    with pytest.raises(JsonError, match="nested too deeply"):
        read('{"c": ' + "[" * 100_000)


def test_only_a_little_is_held_at_a_time(monkeypatch):
    monkeypatch.setattr(json_stream, "PIECE", 1000)
    item = json.dumps({"n": "x" * 80})
    lines = ['{"a": [', *[f"{item}," for _ in range(5000)], f"{item}]}}"]
    stream, most = JsonStream(lines), 0
    for _ in stream.members():
        for _ in stream.items():
            most = max(most, len(stream._buffer))
    assert most < 3000
