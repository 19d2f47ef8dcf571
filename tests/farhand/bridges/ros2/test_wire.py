"""Keys, tokens, attachments and hashes against what is known of rmw_zenoh, and against pamoja-ros2 and Zenoh's own."""

import pytest
import xxhash
from hypothesis import given
from hypothesis import strategies as st
from pamoja import ros2 as pamoja
from zenoh.ext import Int64, z_serialize

from farhand.bridges.ros2.cdr.types import DISTROS, Types
from farhand.bridges.ros2.graph.wire import (
    LATCHED,
    RELIABLE,
    ROSOUT,
    SENSOR,
    Attachment,
    check_namespace,
    data_key,
    endpoint_token,
    gid_of,
    node_name,
    node_token,
    read_attachment,
)
from farhand.common.errors import InputError

HASHES = {
    "sensor_msgs/msg/JointState": "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e",
    "geometry_msgs/msg/TwistStamped": "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64",
    "sensor_msgs/msg/Joy": "0d356c79cad3401e35ffeb75a96a96e08be3ef896b8b83841d73e890989372c5",
    "tf2_msgs/msg/TFMessage": "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    "visualization_msgs/msg/MarkerArray": "86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf",
    "sensor_msgs/msg/CompressedImage": "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a",
    "diagnostic_msgs/msg/DiagnosticArray": "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
    "std_srvs/srv/Trigger": "eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f",
}
JOINTS = "sensor_msgs/msg/JointState"
GIDS = st.binary(min_size=16, max_size=16)


@pytest.mark.parametrize("distro", DISTROS)
def test_hashes_are_those_of_ros(distro):
    types = Types(distro)
    assert {kind: types.hash_of(kind) for kind in HASHES} == {
        kind: f"RIHS01_{h}" for kind, h in HASHES.items()
    }


def test_humble_and_what_is_none_are_refused():
    with pytest.raises(InputError, match="has no type hashes"):
        Types("humble")
    with pytest.raises(InputError, match="must be jazzy, kilted, lyrical"):
        Types("jazy")


def test_keys_are_those_of_another_library():
    type_hash = f"RIHS01_{HASHES[JOINTS]}"
    key = data_key(7, "/cell_1/joint_states", JOINTS, type_hash)
    assert key == pamoja.entity_key(7, "/cell_1/joint_states", JOINTS, type_hash)
    assert key == f"7/cell_1/joint_states/sensor_msgs::msg::dds_::JointState_/{type_hash}"


def test_tokens_are_those_of_the_documents():
    node = node_token(3, "abc", 0, "/farhand", "ur5")
    assert node == "@ros2_lv/3/abc/0/0/NN/%/%farhand/ur5"
    assert node_token(0, "abc", 0, "", "ur5").split("/")[7] == "%"
    token = endpoint_token(node, 4, "MP", "/farhand/joint_states", JOINTS, "RIHS01_0", SENSOR)
    assert token == (
        "@ros2_lv/3/abc/0/4/MP/%/%farhand/ur5/%farhand%joint_states/"
        "sensor_msgs::msg::dds_::JointState_/RIHS01_0/2::,5:,:,:,,"
    )
    assert (RELIABLE.text, LATCHED.text, ROSOUT.text) == (
        "::,10:,:,:,,",
        ":1:,1:,:,:,,",
        ":1:,1000:,:10,0:,,",
    )
    assert gid_of(token) == xxhash.xxh3_128(token.encode()).digest()[::-1]


@given(st.integers(0, 2**63 - 1), st.integers(-(2**63), 2**63 - 1), GIDS)
def test_attachments_are_those_of_zenoh(seq, sent_ns, gid):
    attachment = Attachment(seq, sent_ns, gid)
    assert attachment.to_bytes() == z_serialize((Int64(seq), Int64(sent_ns), gid)).to_bytes()
    assert read_attachment(attachment.to_bytes()) == attachment


@given(st.binary(max_size=40))
def test_no_bytes_are_more_than_an_attachment(payload):
    found = read_attachment(payload)
    assert found is None or found.to_bytes() == payload


def test_names_are_those_of_ros():
    assert (node_name("ur5"), node_name("box-2.b"), node_name("5th")) == ("ur5", "box_2_b", "_5th")
    assert check_namespace("/") == ""
    for wrong in ("farhand", "/a b", "/1a", "//a"):
        with pytest.raises(InputError):
            check_namespace(wrong)
