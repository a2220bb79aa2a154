"""The simulated camera at the simulated flange: what it sees depends on where the arm really is."""

from __future__ import annotations

import time

import numpy as np

from core.geometry import FloatArray
from hardware.interfaces import CameraImage, Robot
from hardware.simulation.depth_camera import SimulatedDepthCamera
from hardware.simulation.depth_noise import DepthNoise, disturb_pose
from hardware.simulation.world import World

_JOINT_STEP_RAD = 1e-4
_POSE_STREAM, _IMAGE_STREAM = 0, 1


class SimulatedCamera:
    """Looks at a world from the robot's flange, with the noise of a PrimeSense Carmine 1.09.

    The error of its pose belongs to the configuration, as that of a real arm's kinematics does; the images
    differ from shot to shot. Both follow from the seed and the joint angles alone, so a scan that was
    interrupted and continued is the same as one that was not.

    Attributes:
        name: marks it as simulated.
    """

    def __init__(
        self, world: World, robot: Robot, T_flange_camera: FloatArray, noise: DepthNoise | None, seed: int
    ) -> None:
        """Hang at the flange; `noise=None` makes it perfect at exactly known poses."""
        self.name = "simulated camera"
        self._sensor = SimulatedDepthCamera(world, noise)
        self._robot = robot
        self._T_flange_camera = T_flange_camera
        self._noise = noise
        self._seed = seed
        self._shots: dict[tuple[int, ...], int] = {}

    def __enter__(self) -> SimulatedCamera:
        return self

    def __exit__(self, *exception: object) -> None:
        pass

    def capture(self) -> CameraImage:
        """Take an image from where the arm is now; 60 ms."""
        state = self._robot.state()
        place = tuple(int(step) for step in np.round(state.joints_rad / _JOINT_STEP_RAD))
        shot = self._shots[place] = self._shots.get(place, -1) + 1
        T_true = state.T_base_flange @ self._T_flange_camera
        if self._noise is not None:
            T_true = disturb_pose(T_true, self._noise, self._random(place, _POSE_STREAM))
        color, depth = self._sensor.capture(T_true, self._random(place, _IMAGE_STREAM, shot))
        return CameraImage(color, depth, self._sensor.intrinsics, time.monotonic())

    def _random(self, place: tuple[int, ...], *stream: int) -> np.random.Generator:
        # Seeds are counted from zero; a whole turn is far below this.
        return np.random.default_rng([self._seed, *(step + 1_000_000 for step in place), *stream])
