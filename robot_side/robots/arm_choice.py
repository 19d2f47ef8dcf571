"""The arm that a scenario's robot is."""

import dataclasses

import numpy as np

from farhand.robot_side.arm.model import ArmModel, model
from farhand.robot_side.robots.settings import RobotSettings


def chosen_arm(settings: RobotSettings) -> ArmModel:
    """The model, its accelerations within `robot.max_joint_acceleration`."""
    arm = model(settings.kind)
    most = np.minimum(arm.max_acceleration, settings.max_joint_acceleration)
    return dataclasses.replace(arm, max_acceleration=most)
