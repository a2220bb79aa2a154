"""Where the pictures are taken from: a three-quarter view from above that shows the inside."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, degrees, radians, sin, tan

import numpy as np

from core.geometry import FloatArray

_FIELD_OF_VIEW_RAD = radians(30)
_AZIMUTH_RAD = radians(28)
_LOWEST_RAD, _HIGHEST_RAD = radians(40), radians(60)
_MARGIN = 0.04
"""Share of the picture that is left free on every side."""


@dataclass(frozen=True)
class Camera:
    """A pinhole camera whose picture's upper edge points to world +z.

    Attributes:
        eye_m: (3,) position.
        forward: (3,) unit vector of the line of sight.
        aspect: width over height.
        reach_m: distance to the farthest point of interest.
    """

    eye_m: FloatArray
    forward: FloatArray
    aspect: float
    reach_m: float

    @property
    def field_of_view_deg(self) -> float:
        """Vertical field of view."""
        return degrees(_FIELD_OF_VIEW_RAD)

    def blended(self, other: Camera, share: float) -> Camera:
        """Return the camera moved towards `other` (same direction) by a `share` of the distance."""
        eye = (1 - share) * self.eye_m + share * other.eye_m
        return Camera(eye, self.forward, self.aspect, max(self.reach_m, other.reach_m))


def view_direction(extents_m: FloatArray) -> FloatArray:
    """Line of sight (3,) onto an object with AABB edges `extents_m`: its long side lies across the picture.

    The higher the object for its width, the steeper the view, so that its inside is seen.
    """
    slenderness = extents_m[2] / max(min(extents_m[0], extents_m[1]), 1e-6)
    elevation = np.clip(radians(35 + 20 * slenderness), _LOWEST_RAD, _HIGHEST_RAD)
    azimuth = _AZIMUTH_RAD - radians(90) if extents_m[0] >= extents_m[1] else _AZIMUTH_RAD
    to_camera = [cos(azimuth) * cos(elevation), sin(azimuth) * cos(elevation), sin(elevation)]
    return -np.array(to_camera)


def frame(points_m: FloatArray, forward: FloatArray, aspect: float) -> Camera:
    """Return the nearest camera looking along `forward` that sees all of `points_m` (n, 3).

    A margin is left free on every side.
    """
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    tangent_up = tan(_FIELD_OF_VIEW_RAD / 2) * (1 - 2 * _MARGIN)
    depth = points_m @ forward
    along_right, back_right = _between(points_m @ right, depth, tangent_up * aspect)
    along_up, back_up = _between(points_m @ up, depth, tangent_up)
    back = min(back_right, back_up)
    eye = along_right * right + along_up * up + back * forward
    return Camera(eye, forward, aspect, float(depth.max() - back))


def light_direction(forward: FloatArray) -> FloatArray:
    """Unit vector (3,) to the lamp: high and to the left of the camera, where the ground shows no glare."""
    azimuth = np.arctan2(-forward[1], -forward[0]) - radians(75)
    elevation = radians(58)
    return np.array([cos(azimuth) * cos(elevation), sin(azimuth) * cos(elevation), sin(elevation)])


def _between(across: FloatArray, depth: FloatArray, tangent: float) -> tuple[float, float]:
    """Place the eye between the two planes that bound the view: its coordinates across and in depth."""
    plus = float((across - tangent * depth).max())
    minus = float((-across - tangent * depth).max())
    return (plus - minus) / 2, -(plus + minus) / (2 * tangent)


def aabb_corners(low_m: FloatArray, high_m: FloatArray) -> FloatArray:
    """The eight corners (8, 3) of a box."""
    choices = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T
    corners: FloatArray = np.where(choices, high_m, low_m)
    return corners
