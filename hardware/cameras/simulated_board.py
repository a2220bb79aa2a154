"""The simulated camera over a calibration board: what it sees depends on where the arm really is."""

from __future__ import annotations

import time

import numpy as np

from core.calibration.board import BoardSpec
from core.geometry import FloatArray, invert_pose
from core.motion.arm_models import ArmModel
from core.motion.kinematics import flange_pose
from hardware.interfaces import CameraImage, Robot
from hardware.simulation.board_view import BoardLook, BoardPainter, lying_board
from hardware.simulation.depth_camera import HEIGHT, WIDTH, SimulatedDepthCamera
from hardware.simulation.depth_noise import DepthNoise, disturb
from hardware.simulation.set_up import SetUp
from hardware.simulation.world import World

_JOINT_STEP_RAD = 1e-4
_POSE_STREAM, _IMAGE_STREAM = 3, 4


class SimulatedBoardCamera:
    """Looks at a board on the table from the flange of an arm with errors of its own.

    The arm's error belongs to the configuration, the image's noise differs from shot to shot; both follow
    from the seed and the joint angles alone.

    Attributes:
        name: marks it as simulated.
        T_base_board: (4, 4) where the board lies; may be moved.
    """

    def __init__(
        self,
        world: World,
        robot: Robot,
        arm: ArmModel,
        set_up: SetUp,
        board: BoardSpec,
        noise: DepthNoise | None,
    ) -> None:
        """Hang at the flange as the set-up says; `board` has the squares that it really has."""
        self.name = "simulated camera"
        self._robot, self._arm, self._set_up, self._board = robot, set_up.own_arm(arm), set_up, board
        self._sensor = SimulatedDepthCamera(world, noise)
        self._noise = noise
        lens = set_up.lens(self._sensor.intrinsics)
        self._painter = BoardPainter(board, lens, (WIDTH, HEIGHT))
        self._n_shots = 0
        self.T_base_board = self.lying(np.array(set_up.board_middle_m), set_up.board_yaw_rad)

    def __enter__(self) -> SimulatedBoardCamera:
        return self

    def __exit__(self, *exception: object) -> None:
        pass

    def lying(self, middle_m: FloatArray, yaw_rad: float) -> FloatArray:
        """Return `T_base_board` (4, 4) of the board lying with its middle at (3,)."""
        return lying_board(self._board, middle_m, yaw_rad)

    def capture(self) -> CameraImage:
        """Take an image from where the arm is now; 0.3 s."""
        joints = self._robot.state().joints_rad
        place = [int(step) + 1_000_000 for step in np.round(joints / _JOINT_STEP_RAD)]
        seed = self._set_up.seed
        flange = flange_pose(self._arm, joints)
        flange = self._set_up.flexed(flange, np.random.default_rng([seed, *place, _POSE_STREAM]))
        T_base_camera = flange @ self._set_up.camera_pose
        self._n_shots += 1
        random = np.random.default_rng([seed, *place, _IMAGE_STREAM, self._n_shots])
        color, depth = self._sensor.capture(T_base_camera, random)
        look = BoardLook(self._set_up.blur_px, self._set_up.noise_levels)
        T_camera_board = invert_pose(T_base_camera) @ self.T_base_board
        color, board_depth = self._painter.paint(color, T_camera_board, look, random)
        on_board = np.isfinite(board_depth)
        depth[on_board] = self._measured(board_depth, random)[on_board]
        return CameraImage(color, depth, self._sensor.intrinsics, time.monotonic())

    def _measured(self, board_depth: FloatArray, random: np.random.Generator) -> FloatArray:
        true_depth = np.where(np.isfinite(board_depth), board_depth, 0.0)
        if self._noise is None:
            return true_depth
        return disturb(true_depth, np.zeros_like(true_depth), self._noise, random)
