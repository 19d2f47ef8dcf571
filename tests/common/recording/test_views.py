"""What a run tells beside its bytes: messages as JSON, to seven digits, and pictures without their bytes."""

import io

import msgspec
from mcap.reader import make_reader

from farhand.common.messages.camera import CameraFrame
from farhand.common.messages.codec import encode
from farhand.common.recording.json_view import shortened
from farhand.common.recording.records import RunInfo, TickRecord
from farhand.common.recording.run_file import RunFile
from farhand.foxglove.view import views_of
from farhand.testing import report
from farhand.testing.disk import ScriptedFile

EPOCH_NS = 1_700_000_000_000_000_000
INFO = RunInfo(scenario={"name": "x"}, robot="r", session=3, seed=1, versions={}, epoch_ns=EPOCH_NS)


def test_a_picture_is_an_image_for_viewers_and_a_line_for_programs():
    disk = ScriptedFile()
    file = RunFile(None, INFO, views_of(INFO), file=disk)
    file.tick(TickRecord(0, 5, (), None, encode(report(0))))
    frame = CameraFrame(
        source="r", session=1, seq=4, t_sent_ns=9, camera="pybullet", width=32, height=24, jpeg=b"\xff\xd8abc"
    )
    file.frame(frame, EPOCH_NS + 70)
    file.close()
    found = {c.topic: (s, m) for s, c, m in make_reader(io.BytesIO(disk.read_bytes())).iter_messages()}
    schema, image = found["/camera"]
    assert schema.name == "foxglove.CompressedImage"
    assert image.log_time == EPOCH_NS + 70
    assert frame.jpeg in image.data
    told = msgspec.json.decode(found["/robot/camera"][1].data)
    assert (told["camera"], told["width"], told["jpeg"]) == ("pybullet", 32, len(frame.jpeg))
    assert found["/operator/report"][1].log_time == EPOCH_NS + 5


def test_numbers_keep_six_digits():
    assert shortened({"a": [0.123456789123, 2, "x", None], "b": (1e-12 / 3,)}) == {
        "a": [0.123457, 2, "x", None],
        "b": [3.33333e-13],
    }
