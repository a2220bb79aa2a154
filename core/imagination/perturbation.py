"""The small perturbations of pose under which candies must stay (Sec. III-A, Fig. 3a)."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from core.geometry import FloatArray, make_pose, rotation_x, rotation_y
from core.imagination.bullet_world import GRAVITY_M_S2, BulletWorld
from core.imagination.rotations import quaternion_of
from core.parameters.imagination import ContainabilityParameters


@dataclass(frozen=True)
class Motion:
    """Where the object is at a moment, how it turns, and the force field.

    Attributes:
        T_world_object: (4, 4) pose relative to the object at rest.
        angular_velocity_rad_s: (3,) about the pivot.
        gravity_m_s2: (3,).
    """

    T_world_object: FloatArray
    angular_velocity_rad_s: FloatArray
    gravity_m_s2: FloatArray


class Perturbation:
    """Drop, one sine about x, one about y, then four horizontal pushes, one after another."""

    def __init__(self, parameters: ContainabilityParameters, center_of_mass_m: FloatArray) -> None:
        """Rotations are about axes through `center_of_mass_m` (3,), as the body frame is attached there."""
        self._parameters = parameters
        self._pivot_m = center_of_mass_m
        self._rotations_from_s = parameters.drop_s
        self._pushes_from_s = parameters.drop_s + 2 * parameters.rotation_s
        self.duration_s = self._pushes_from_s + 4 * parameters.translation_s

    def reach_m(self, aabb_m: FloatArray) -> FloatArray:
        """Return the box (2, 3) that holds an object with the box `aabb_m` (2, 3) however it is turned."""
        corners = np.array([[x, y, z] for x in aabb_m[:, 0] for y in aabb_m[:, 1] for z in aabb_m[:, 2]])
        farthest_m = float(np.linalg.norm(corners - self._pivot_m, axis=1).max())
        # No point moves on by more than the chord of the largest turn, about x and y together.
        moved_m = 2 * farthest_m * sin(self._parameters.rotation_rad / 2)
        return np.array([aabb_m[0] - moved_m, aabb_m[1] + moved_m])

    def at(self, time_s: float) -> Motion:
        """Return the motion at `time_s` after the start."""
        angle_x, rate_x = self._rotation(time_s - self._rotations_from_s)
        angle_y, rate_y = self._rotation(time_s - self._rotations_from_s - self._parameters.rotation_s)
        rotation = rotation_x(angle_x) @ rotation_y(angle_y)
        return Motion(
            make_pose(rotation, self._pivot_m - rotation @ self._pivot_m),
            np.array([rate_x, rate_y, 0.0]),
            self._gravity(time_s),
        )

    def _rotation(self, since_s: float) -> tuple[float, float]:
        """Angle and rate of one sine that starts at zero."""
        length = self._parameters.rotation_s
        if not 0 <= since_s < length:
            return 0.0, 0.0
        frequency = 2 * pi / length
        amplitude = self._parameters.rotation_rad
        return amplitude * sin(frequency * since_s), amplitude * frequency * cos(frequency * since_s)

    def _gravity(self, time_s: float) -> FloatArray:
        directions = ((1, 0), (-1, 0), (0, 1), (0, -1))
        if time_s < self._pushes_from_s or self._parameters.translation_s == 0:
            return np.array([0.0, 0.0, -GRAVITY_M_S2])
        index = min(int((time_s - self._pushes_from_s) / self._parameters.translation_s), 3)
        push = self._parameters.translation_m_s2
        return np.array([push * directions[index][0], push * directions[index][1], -GRAVITY_M_S2])


def move_object(world: BulletWorld, body_id: int, motion: Motion, center_of_mass_m: FloatArray) -> None:
    """Put a driven body and the force field where `motion` has them, for the next step."""
    world.set_gravity(motion.gravity_m_s2)
    position, angular = motion.T_world_object[:3, 3], motion.angular_velocity_rad_s
    velocity = np.cross(angular, position - center_of_mass_m)
    world.drive(body_id, position, quaternion_of(motion.T_world_object[:3, :3]), velocity, angular)
