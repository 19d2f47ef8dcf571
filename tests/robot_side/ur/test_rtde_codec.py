"""RTDE's packages: what is packed is taken, in whatever pieces it comes; what is none is refused."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.robot_side.ur.rtde_codec import FORMATS, HEADER, BrokenStreamError, Recipe, pack, take

REALS = st.floats(allow_nan=False)
VALUES = {
    "BOOL": st.booleans(),
    "UINT8": st.integers(0, 255),
    "UINT32": st.integers(0, 2**32 - 1),
    "UINT64": st.integers(0, 2**64 - 1),
    "INT32": st.integers(-(2**31), 2**31 - 1),
    "DOUBLE": REALS,
    "VECTOR3D": st.lists(REALS, min_size=3, max_size=3),
    "VECTOR6D": st.lists(REALS, min_size=6, max_size=6),
    "VECTOR6INT32": st.lists(st.integers(-(2**31), 2**31 - 1), min_size=6, max_size=6),
    "VECTOR6UINT32": st.lists(st.integers(0, 2**32 - 1), min_size=6, max_size=6),
}
FIELDS = st.lists(
    st.sampled_from(sorted(FORMATS)).flatmap(lambda kind: st.tuples(st.just(kind), VALUES[kind])), max_size=12
)


@given(fields=FIELDS, number=st.integers(1, 255))
def test_values_of_a_recipe_come_back(fields, number):
    recipe = Recipe(number, [f"v{i}" for i in range(len(fields))], [kind for kind, _ in fields])
    values = [value for _, value in fields]
    assert recipe.unpack(recipe.pack(values)) == values


@given(fields=FIELDS, cut=st.integers(0, 400), other=st.integers(1, 255))
def test_a_payload_that_does_not_fit_is_refused(fields, cut, other):
    recipe = Recipe(7, [f"v{i}" for i in range(len(fields))], [kind for kind, _ in fields])
    payload = recipe.pack([value for _, value in fields])
    if cut < len(payload):
        with pytest.raises(BrokenStreamError):
            recipe.unpack(payload[:cut])
    if other != 7:
        with pytest.raises(BrokenStreamError):
            recipe.unpack(bytes([other]) + payload[1:])


@given(
    packages=st.lists(st.tuples(st.integers(0, 255), st.binary(max_size=50)), max_size=10),
    sizes=st.lists(st.integers(1, 20), min_size=1, max_size=10),
)
def test_packages_come_out_whole_and_in_order_whatever_the_pieces(packages, sizes):
    stream = b"".join(pack(kind, payload) for kind, payload in packages)
    buffer, found, at, turn = bytearray(), [], 0, 0
    while at < len(stream):
        size = sizes[turn % len(sizes)]
        buffer += stream[at : at + size]
        found += [(each.kind, each.payload) for each in take(buffer)]
        at, turn = at + size, turn + 1
    assert found == packages
    assert not buffer


@given(size=st.integers(0, HEADER.size - 1), rest=st.binary(max_size=10))
def test_a_package_shorter_than_its_header_ends_the_stream(size, rest):
    with pytest.raises(BrokenStreamError):
        take(bytearray(HEADER.pack(size, 85) + rest))


def test_not_a_number_travels():
    recipe = Recipe(1, ["x"], ["DOUBLE"])
    assert math.isnan(recipe.unpack(recipe.pack([math.nan]))[0])
