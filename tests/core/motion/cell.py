"""The simulated cell: a UR5 with gripper and camera; a platform and the object's box on a table."""

import numpy as np

from core.geometry import make_pose, rotation_x
from core.motion.arm_models import UR5, Capsule, arm_shape, capsule_around_box
from core.motion.clearance import MotionScene, axis_aligned_obstacle
from core.motion.views import ViewTask

T_FLANGE_CAMERA = make_pose(rotation_x(np.radians(-30)), (0, -0.09, 0.08))
"""90 mm beside the flange axis, 80 mm forward, the optical axis 30 degrees towards the flange axis: the
gripper (40 mm around, 120 mm long) stays 9 degrees outside of the image at every depth."""
HOME_RAD = np.array([4.57, -1.5, -0.6, -2.25, 1.5, 0.7])
BOX_MIN_M, BOX_MAX_M = np.array([-0.30, -0.55, 0.03]), np.array([0.18, -0.15, 0.35])
TASK = ViewTask(T_FLANGE_CAMERA, np.array([-0.06, -0.35, 0.14]), BOX_MIN_M, BOX_MAX_M, HOME_RAD)


def simulated_cell() -> MotionScene:
    tools = [
        Capsule("gripper", 6, (0, 0, 0), (0, 0, 0.08), 0.04),
        capsule_around_box("camera", T_FLANGE_CAMERA, (0.18, 0.036, 0.025)),
    ]
    # the shoulder is always less than the wanted 20 mm over the table; the elbow answers for the upper arm
    stands_there = frozenset({"base", "shoulder", "upper arm"})
    obstacles = [
        axis_aligned_obstacle("table", (-1.5, -1.5, -0.5), (1.5, 1.5, 0.015), stands_there),
        axis_aligned_obstacle("platform", (-0.26, -0.53, 0.015), (0.14, -0.17, 0.08)),
        axis_aligned_obstacle("object's box", BOX_MIN_M, BOX_MAX_M),
    ]
    return MotionScene(UR5, arm_shape(UR5, tools), obstacles)
