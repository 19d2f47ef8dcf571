"""The stamp in a picture: read back after any JPEG, and never read where it is not."""

import numpy as np
import pytest
import simplejpeg
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.robot_side.camera.settings import LEAST_QUALITY, MOST_QUALITY
from farhand.robot_side.camera.strip import (
    LEAST_HEIGHT,
    LEAST_WIDTH,
    StripError,
    draw_strip,
    read_strip,
    strip_height,
)

stamps = st.integers(0, 2**63 - 1)
subsampling = st.sampled_from(["444", "422", "420"])


def noise(width, height, seed, channels=3):
    return np.random.default_rng(seed).integers(0, 256, (height, width, channels), np.uint8)


@settings(max_examples=150, deadline=None)
@given(
    stamps,
    st.integers(1, 100),
    st.integers(LEAST_WIDTH, 700),
    st.integers(LEAST_HEIGHT, 500),
    st.integers(0, 99),
    subsampling,
)
def test_a_stamp_survives_jpeg_of_any_quality_in_a_picture_of_any_size(
    ns, quality, width, height, seed, ways
):
    picture = noise(width, height, seed)
    draw_strip(picture, ns)
    jpeg = simplejpeg.encode_jpeg(picture, quality, "RGB", ways)
    assert read_strip(simplejpeg.decode_jpeg(jpeg)) == ns


@settings(max_examples=50, deadline=None)
@given(stamps, st.integers(LEAST_QUALITY, MOST_QUALITY), st.integers(-30, 30), st.integers(0, 99))
def test_it_survives_a_second_jpeg_and_another_brightness(ns, quality, brighter, seed):
    picture = noise(320, 240, seed)
    draw_strip(picture, ns)
    once = simplejpeg.decode_jpeg(simplejpeg.encode_jpeg(picture, quality, "RGB", "420"))
    lit = np.clip(once.astype(np.int16) + brighter, 0, 255).astype(np.uint8)
    assert read_strip(simplejpeg.decode_jpeg(simplejpeg.encode_jpeg(lit, quality, "RGB", "420"))) == ns


def test_a_picture_without_one_has_none_and_what_is_around_it_stays():
    picture = noise(320, 240, 1, channels=4)
    with pytest.raises(StripError, match="no strip"):
        read_strip(picture)
    before = picture.copy()
    draw_strip(picture, 7)
    assert strip_height(320) == 16
    assert (picture[:224] == before[:224]).all()
    assert (picture[:, :, 3] == before[:, :, 3]).all()
    picture[230, :100] = 255 - picture[230, :100]
    assert read_strip(picture) == 7
    picture[224:232, 8:16, :3] = 255 - picture[224:232, 8:16, :3]
    with pytest.raises(StripError):
        read_strip(picture)
    with pytest.raises(StripError, match="160 x 120"):
        read_strip(picture[:100])
