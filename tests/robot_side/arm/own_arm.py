"""A small arm of six axes as a user's URDF: boxes, cylinders and spheres for links, a gripper that slides."""

import re

LINK = '<link name="{name}"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>{shape}</link>'  # noqa: E501
CYLINDER = '<collision><origin xyz="0 0 0.12"/><geometry><cylinder radius="0.04" length="0.24"/></geometry></collision>'
LIMIT = '<limit lower="-2.9" upper="2.9" velocity="2" effort="80"/>'
AXES = ("0 0 1", "0 1 0", "0 1 0", "0 0 1", "0 1 0", "0 0 1")
HOME = (0.0, 0.5, 1.2, 0.0, 1.4416, 0.0)


def urdf(changes=()):
    """Its text; each change is (pattern, replacement), the first match is replaced."""
    links = [LINK.format(name="base", shape="")]
    links += [LINK.format(name=f"link{i}", shape=CYLINDER) for i in range(1, 7)]
    links.append(
        '<link name="hand"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>'
    )
    links.append(
        '<link name="finger"><collision><geometry><box size="0.02 0.02 0.1"/></geometry></collision></link>'
    )
    joints = [
        f'<joint name="j{i}" type="revolute"><parent link="{"base" if i == 1 else f"link{i - 1}"}"/>'
        f'<child link="link{i}"/><origin xyz="0 0 {0.1 if i == 1 else 0.24}"/><axis xyz="{axis}"/>{LIMIT}</joint>'
        for i, axis in enumerate(AXES, start=1)
    ]
    joints.append(
        '<joint name="flange" type="fixed"><parent link="link6"/><child link="hand"/><origin xyz="0 0 0.24"/></joint>'
    )
    joints.append(
        '<joint name="grip" type="prismatic"><parent link="hand"/><child link="finger"/><origin xyz="0 0 0.08"/>'
        '<axis xyz="1 0 0"/><limit lower="0" upper="0.04" velocity="1" effort="9"/></joint>'
    )
    text = f'<robot name="mine">{"".join(links)}{"".join(joints)}</robot>'
    for pattern, replacement in changes:
        text, count = re.subn(pattern, replacement, text, count=1)
        assert count, pattern
    return text


SRDF = (
    '<robot name="mine"><end_effector name="e" parent_link="hand" group="arm"/>'
    '<group_state name="home" group="arm">'
    + "".join(f'<joint name="j{i}" value="{angle}"/>' for i, angle in enumerate(HOME, start=1))
    + "</group_state>"
    + "".join(f'<disable_collisions link1="link{i}" link2="link{i + 1}"/>' for i in range(1, 6))
    + '<disable_collisions link1="link6" link2="hand"/><disable_collisions link1="link5" link2="hand"/></robot>'
)
