"""What rmw_zenoh writes on the wire: keys, liveliness tokens, qualities of service, attachments.

    data   DOMAIN/TOPIC/PACKAGE::msg::dds_::TYPE_/HASH
    node   @ros2_lv/DOMAIN/SESSION/NODE/NODE/NN/%/NAMESPACE/NODE_NAME
    other  @ros2_lv/DOMAIN/SESSION/NODE/ID/KIND/%/NAMESPACE/NODE_NAME/%TOPIC/TYPE/HASH/QOS

Source: ros2/rmw_zenoh, docs/design.md, liveliness_utils.cpp, attachment_helpers.cpp, qos.cpp.
"""

import re
import struct
from dataclasses import dataclass
from typing import Literal, NamedTuple

from farhand.common.errors import InputError

ROOT = "@ros2_lv"
MAX_DOMAIN = 232
Kind = Literal["MP", "MS", "SS", "SC"]
"""Publisher, subscription, service, client."""
_ATTACHMENT = struct.Struct("<qqB16s")
_GID = 16
_NAMESPACE = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)*\Z")


@dataclass(frozen=True, slots=True)
class Qos:
    """Attributes:
    reliable: or best effort.
    latched: what was sent last is there for who comes late (transient local).
    depth: how many of them.
    lifespan: how long one counts (s); 0: for ever.
    """

    reliable: bool = True
    latched: bool = False
    depth: int = 10
    lifespan: int = 0

    @property
    def text(self) -> str:
        """As a token has it: what is at its default is empty."""
        lifespan = f"{self.lifespan},0" if self.lifespan else ","
        return f"{'' if self.reliable else 2}:{1 if self.latched else ''}:,{self.depth}:,:{lifespan}:,,"


RELIABLE, SENSOR, LATCHED = Qos(), Qos(reliable=False, depth=5), Qos(latched=True, depth=1)
ROSOUT = Qos(latched=True, depth=1000, lifespan=10)
SERVICE = Qos()


class Attachment(NamedTuple):
    """What goes with each message.

    Attributes:
        seq: counts its sender's messages.
        sent_ns: the sender's time of day (ns since 1970).
        gid: which sender.
    """

    seq: int
    sent_ns: int
    gid: bytes

    def to_bytes(self) -> bytes:
        """33 of them."""
        return attachment_bytes(self.seq, self.sent_ns, self.gid)


def attachment_bytes(seq: int, sent_ns: int, gid: bytes) -> bytes:
    """The bytes of an Attachment."""
    return _ATTACHMENT.pack(seq, sent_ns, _GID, gid)


def read_attachment(payload: bytes | None) -> Attachment | None:
    """The attachment; None where it is none, or another form of one."""
    if payload is None or len(payload) != _ATTACHMENT.size:
        return None
    seq, sent_ns, size, gid = _ATTACHMENT.unpack(payload)
    return Attachment(seq, sent_ns, gid) if size == _GID and seq >= 0 else None


def gid_of(token: str) -> bytes:
    """What identifies who declared that token."""
    import xxhash  # of the extra

    return bytes(xxhash.xxh3_128_digest(token.encode())[::-1])


def dds_name(kind: str) -> str:
    """`std_srvs/srv/Trigger` as keys have it."""
    package, folder, name = kind.split("/")
    return f"{package}::{folder}::dds_::{name}_"


def data_key(domain: int, topic: str, kind: str, type_hash: str) -> str:
    """Where a topic's messages go, and a service's requests."""
    return f"{domain}/{topic.lstrip('/')}/{dds_name(kind)}/{type_hash}"


def mangled(name: str) -> str:
    """A name as one part of a key."""
    return name.replace("/", "%") or "%"


def node_token(domain: int, session: str, node: int, namespace: str, name: str) -> str:
    """What shows a node."""
    return f"{ROOT}/{domain}/{session}/{node}/{node}/NN/%/{mangled(namespace)}/{mangled(name)}"


def endpoint_token(
    node: str, number: int, kind: Kind, topic: str, type_name: str, type_hash: str, qos: Qos
) -> str:
    """What shows a publisher, subscription or service of a node.

    Args:
        node: the node's own token.
        number: of the endpoint, one of its own in the session.
        kind: what it is.
        topic: with its namespace.
        type_name: as in ROS.
        type_hash: of it.
        qos: of it.
    """
    root, domain, session, node_number, _, _, *whose = node.split("/")
    head = "/".join([root, domain, session, node_number, str(number), kind, *whose])
    return f"{head}/{mangled(topic)}/{dds_name(type_name)}/{type_hash}/{qos.text}"


def check_namespace(namespace: str, option: str = "--namespace") -> str:
    """The namespace, empty for the root, or a topic's full name; raises InputError that names the option."""
    found = namespace.rstrip("/")
    if not _NAMESPACE.match(found):
        raise InputError(
            f"{option} {namespace!r}: expected a slash, then letters, digits and underscores such as /farhand/cell_1"
        )
    return found


def node_name(robot: str) -> str:
    """What a robot's node is called: a name of ROS has letters, digits and underscores."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", robot)
    return f"_{name}" if name[0].isdigit() else name
