"""The camera's pictures as one H.264 file: a picture a frame of the dataset, the newest that had arrived."""

import io
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from farhand.common.errors import RunFileError
from farhand.exports.images import Image
from farhand.exports.statistics import Statistics

CODEC = "libx264"
SAMPLES = 100
"""Pictures of an episode from which its statistics are."""


class Video:
    """Args:
    path: of the file.
    fps: pictures a second.

    Attributes:
        statistics: of each episode, of its pictures' colours from 0 to 1.
    """

    def __init__(self, path: Path, fps: float) -> None:
        import av

        path.parent.mkdir(parents=True, exist_ok=True)
        self._path, self._fps, self._av = path, fps, av
        self._container: Any = av.open(str(path), "w")
        self._stream: Any = None
        self._size = (0, 0)
        self._count = 0
        self.statistics: list[Statistics] = []

    def add(self, images: Sequence[Image]) -> None:
        """The pictures of an episode; raises RunFileError where one is none, or of another size."""
        step = max(1, len(images) // SAMPLES)
        sampled = []
        for number, image in enumerate(images):
            picture = self._decoded(image)
            if self._stream is None:
                self._begin(picture.size)
            if picture.size != self._size:
                raise RunFileError(f"camera: pictures of {picture.size} and {self._size}; expected one size")
            if number % step == 0:
                sampled.append(np.asarray(picture, dtype=np.float64).reshape(-1, 3) / 255.0)
            frame = self._av.VideoFrame.from_image(picture)  # type: ignore[no-untyped-call]
            frame.pts, frame.time_base = self._count, 1 / Fraction(self._fps)
            self._count += 1
            self._container.mux(self._stream.encode(frame))
        each = Statistics.of([Statistics.measured(pixels) for pixels in sampled])
        low, high, mean, std = (v.reshape(3, 1, 1) for v in (each.low, each.high, each.mean, each.std))
        self.statistics.append(Statistics(low, high, mean, std, len(sampled)))

    def feature(self) -> dict[str, Any]:
        """As info.json describes it."""
        width, height = self._size
        return {
            "dtype": "video",
            "shape": [height, width, 3],
            "names": ["height", "width", "channels"],
            "info": {
                "video.height": height,
                "video.width": width,
                "video.codec": "h264",
                "video.pix_fmt": self._pixels,
                "video.is_depth_map": False,
                "video.fps": self._fps,
                "video.channels": 3,
                "has_audio": False,
            },
        }

    def close(self) -> None:
        """Finish the file."""
        if self._stream is not None:
            self._container.mux(self._stream.encode())
        self._container.close()

    @property
    def _pixels(self) -> str:
        return "yuv420p" if not any(side % 2 for side in self._size) else "yuv444p"

    def _begin(self, size: tuple[int, int]) -> None:
        self._size = size
        rate = Fraction(self._fps).limit_denominator(1000)
        self._stream = self._container.add_stream(CODEC, rate=rate, options={"crf": "23", "g": "2"})
        self._stream.width, self._stream.height = size
        self._stream.pix_fmt = self._pixels

    @staticmethod
    def _decoded(image: Image) -> Any:
        from PIL import Image as Pictures

        try:
            return Pictures.open(io.BytesIO(image.data)).convert("RGB")
        except OSError as error:
            raise RunFileError(f"camera: a picture cannot be read: {error}") from None
