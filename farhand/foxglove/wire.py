"""What is newest of a scene and of frames, without decoding more of Protocol Buffers than names."""

from collections.abc import Iterator

_ENTITIES, _DELETIONS = 2, 1
_TRANSFORMS = 1
_ENTITY_ID, _CHILD = 3, 3
_DELETION_TYPE, _DELETION_ID = 2, 3
_ALL = 1
VARINT, FIXED64, BYTES, FIXED32 = 0, 1, 2, 5


class Scene:
    """All entities of a scene, by many updates, as one update."""

    def __init__(self) -> None:
        self._entities: dict[bytes, bytes] = {}

    def take(self, update: bytes) -> None:
        """A SceneUpdate; raises ValueError where it is none."""
        for number, value in fields(update):
            if not isinstance(value, bytes):
                continue
            if number == _DELETIONS:
                self._delete(dict(fields(value)))
            elif number == _ENTITIES:
                self._entities[_text(value, _ENTITY_ID)] = value

    def whole(self) -> bytes:
        """As one SceneUpdate."""
        return b"".join(_field(_ENTITIES, entity) for entity in self._entities.values())

    @property
    def names(self) -> frozenset[bytes]:
        """Of the entities that are there."""
        return frozenset(self._entities)

    def _delete(self, deletion: dict[int, int | bytes]) -> None:
        if deletion.get(_DELETION_TYPE, 0) == _ALL:
            self._entities.clear()
        else:
            self._entities.pop(bytes(deletion.get(_DELETION_ID, b"") or b""), None)


class Frames:
    """All frames, by many messages, as one."""

    def __init__(self) -> None:
        self._transforms: dict[bytes, bytes] = {}

    def take(self, message: bytes) -> None:
        """A FrameTransforms; raises ValueError where it is none."""
        for number, value in fields(message):
            if number == _TRANSFORMS and isinstance(value, bytes):
                self._transforms[_text(value, _CHILD)] = value

    def whole(self) -> bytes:
        """As one FrameTransforms."""
        return b"".join(_field(_TRANSFORMS, each) for each in self._transforms.values())

    @property
    def names(self) -> frozenset[bytes]:
        """Of the frames that are there."""
        return frozenset(self._transforms)


def fields(message: bytes) -> Iterator[tuple[int, int | bytes]]:
    """The fields of a message in their order: number, and value as written; raises ValueError where it is cut off."""
    at, end = 0, len(message)
    while at < end:
        key, at = _varint(message, at)
        number, kind = key >> 3, key & 7
        if kind == VARINT:
            value, at = _varint(message, at)
            yield number, value
            continue
        if kind == BYTES:
            size, at = _varint(message, at)
        elif kind in (FIXED64, FIXED32):
            size = 8 if kind == FIXED64 else 4
        else:
            raise ValueError(f"a field of kind {kind}")
        if at + size > end:
            raise ValueError("it is cut off")
        yield number, message[at : at + size]
        at += size


def _text(message: bytes, wanted: int) -> bytes:
    for number, value in fields(message):
        if number == wanted and isinstance(value, bytes):
            return value
    return b""


def _field(number: int, value: bytes) -> bytes:
    size, length = len(value), bytearray()
    while size > 0x7F:
        length.append(size & 0x7F | 0x80)
        size >>= 7
    length.append(size)
    return bytes((number << 3 | BYTES,)) + bytes(length) + value


def _varint(message: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        if at >= len(message) or shift > 63:
            raise ValueError("it is cut off")
        byte = message[at]
        value |= (byte & 0x7F) << shift
        at += 1
        if byte < 0x80:
            return value, at
        shift += 7
