"""The types of a ROS 2 distribution: messages, their CDR bytes, and the hashes that their keys carry."""

from typing import Any

from farhand.bridges.ros2.cdr.definitions import MESSAGES, SERVICES
from farhand.common.errors import FarhandError, InputError

DISTROS = ("jazzy", "kilted", "lyrical")
"""Whose types have hashes, and whose rmw_zenoh speaks as written here."""
LONGEST = 1 << 20
"""Bytes of a payload that is looked at."""
LONGEST_SEQUENCE = 1 << 16
_EVENT_INFO = "service_msgs/msg/ServiceEventInfo"


class CdrError(FarhandError):
    """Bytes are no message of their type."""


class Types:
    """Args:
    distro: one of DISTROS.

    Raises:
        InputError: it is none of them, or the extra is not installed.
    """

    def __init__(self, distro: str) -> None:
        if distro == "humble":
            raise InputError("--distro humble: has no type hashes, which every key of rmw_zenoh carries; "
                             f"there are {', '.join(DISTROS)}")  # fmt: skip
        if distro not in DISTROS:
            raise InputError(f"--distro {distro!r}: must be {', '.join(DISTROS)}")
        try:
            import xxhash  # noqa: F401 (said here, before anything is opened)
            from rosbags.typesys import Stores, get_types_from_msg, get_typestore
        except ImportError as error:
            raise InputError(f"{error.name} is missing; pip install 'farhand[ros2]'") from None
        self._store: Any = get_typestore(getattr(Stores, f"ROS2_{distro.upper()}"))
        self._store.max_sequence_length = LONGEST_SEQUENCE
        self._parse = get_types_from_msg
        self._hashes: dict[str, str] = {}
        for name, text in MESSAGES.items():
            self._register(name, text)
        self._know_services()
        self.types: dict[str, Any] = self._store.types

    def make(self, kind: str, /, **fields: Any) -> Any:
        """A message of a kind such as `geometry_msgs/msg/Vector3`."""
        return self.types[kind](**fields)

    def hash_of(self, kind: str) -> str:
        """RIHS01 of a message or a service."""
        if kind not in self._hashes:
            self._hashes[kind] = self._store.hash_rihs01(kind)
        return self._hashes[kind]

    def encode(self, message: Any, kind: str) -> bytes:
        """CDR, little-endian, with its head."""
        return bytes(self._store.serialize_cdr(message, kind, little_endian=True))

    def decode(self, payload: bytes, kind: str) -> Any:
        """The message; raises CdrError."""
        if len(payload) > LONGEST:
            raise CdrError(f"{len(payload)} bytes; at most {LONGEST}")
        try:
            return self._store.deserialize_cdr(payload, kind)
        except Exception as error:  # whatever a parser of foreign bytes may raise
            raise CdrError(f"no {kind}: {type(error).__name__}: {error}") from None

    def definition(self, kind: str) -> str:
        """Its text with those of all parts, as recorders and other libraries take it."""
        return str(self._store.generate_msgdef(kind, ros_version=2)[0])

    def _register(self, name: str, text: str) -> None:
        """Under its true name: the parser of texts knows none but messages'."""
        self._store.register({name: self._parse(text, "farhand/msg/Parsed")["farhand/msg/Parsed"]})

    def _know_services(self) -> None:
        """With the structs that their hashes are of; no event is ever sent."""
        from rosbags.interfaces import Nodetype

        if _EVENT_INFO not in self._store.fielddefs:
            self._register(_EVENT_INFO, "uint8 event_type\nbuiltin_interfaces/Time stamp\n"
                           "uint8[16] client_gid\nint64 sequence_number\n")  # fmt: skip
        constants, fields = self._store.fielddefs[_EVENT_INFO]
        gid = ("client_gid", (Nodetype.ARRAY, ((Nodetype.BASE, ("uint8", 0)), 16)))  # char is an uint8
        self._store.fielddefs[_EVENT_INFO] = (
            constants,
            [gid if name == "client_gid" else (name, kind) for name, kind in fields],
        )
        for service, (request, response) in SERVICES.items():
            self._register(f"{service}_Request", request)
            self._register(f"{service}_Response", response)
            parts = [
                (part, (Nodetype.NAME, f"{service}_{part.capitalize()}")) for part in ("request", "response")
            ]
            event: list[Any] = [("info", (Nodetype.NAME, _EVENT_INFO))]
            event += [(part, (Nodetype.SEQUENCE, (kind, 1))) for part, kind in parts]
            whole: list[Any] = [(f"{part}_message", kind) for part, kind in parts]
            whole.append(("event_message", (Nodetype.NAME, f"{service}_Event")))
            self._store.fielddefs[f"{service}_Event"] = ([], event)
            self._store.fielddefs[service] = ([], whole)
