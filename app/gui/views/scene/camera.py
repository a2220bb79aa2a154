"""The view's camera as plain numbers: it orbits a point, z is up."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from core.geometry import FloatArray, transform_points

Size = tuple[int, int]
"""Width and height in pixels."""

DIRECTIONS = {"iso": (-60.0, 28.0), "top": (-90.0, 90.0), "front": (-90.0, 0.0), "side": (0.0, 0.0)}
"""Azimuth and elevation of the named views."""

_FOV_DEG = 36.0
"""Of the view's height; narrow, so that upright things look upright."""
_MARGIN = 1.16
_ROUNDS = 4
"""Near things look larger: the centre is found by iteration."""
_NEAR, _FAR = 0.02, 60.0
"""Of the distance."""
_NEAREST_M, _FARTHEST_M = 0.02, 50.0


@dataclass(frozen=True)
class Ray:
    """A line of sight.

    Attributes:
        origin_m: (3,) where it starts.
        direction: (3,) unit vector.
        spread: how many metres a pixel covers, a metre away.
    """

    origin_m: FloatArray
    direction: FloatArray
    spread: float

    def transformed(self, T_target_source: FloatArray) -> Ray:
        """The same line in another frame."""
        return Ray(
            transform_points(T_target_source, self.origin_m),
            T_target_source[:3, :3] @ self.direction,
            self.spread,
        )

    def at(self, distance_m: float) -> FloatArray:
        """The point (3,) so far along it."""
        point: FloatArray = self.origin_m + distance_m * self.direction
        return point


@dataclass(frozen=True)
class Camera:
    """Where the view is seen from.

    Attributes:
        center_m: (3,) what it looks at and orbits.
        distance_m: of the eye from there.
        azimuth_deg: direction from the centre to the eye, from +x counter-clockwise seen from above.
        elevation_deg: of the eye above the horizon, -90 to 90.
    """

    center_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    distance_m: float = 2.0
    azimuth_deg: float = DIRECTIONS["iso"][0]
    elevation_deg: float = DIRECTIONS["iso"][1]

    @property
    def axes(self) -> FloatArray:
        """Rows (3, 3): right, up and towards the eye, in the world."""
        a, e = np.radians([self.azimuth_deg, self.elevation_deg])
        ca, sa, ce, se = np.cos(a), np.sin(a), np.cos(e), np.sin(e)
        return np.array([[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]])

    @property
    def eye_m(self) -> FloatArray:
        """Where the eye is (3,)."""
        eye: FloatArray = np.array(self.center_m) + self.distance_m * self.axes[2]
        return eye

    @property
    def T_eye_world(self) -> FloatArray:
        """Pose (4, 4) that takes world points to x right, y up, z towards the viewer."""
        pose = np.eye(4)
        pose[:3, :3] = self.axes
        pose[:3, 3] = -self.axes @ self.eye_m
        return pose

    def projection(self, size: Size) -> FloatArray:
        """OpenGL's projection matrix (4, 4) for a view of that size."""
        near, far = _NEAR * self.distance_m, _FAR * self.distance_m
        up = 1 / np.tan(np.radians(_FOV_DEG) / 2)
        matrix = np.zeros((4, 4))
        matrix[0, 0], matrix[1, 1] = up * size[1] / size[0], up
        matrix[2, 2], matrix[2, 3] = (far + near) / (near - far), 2 * far * near / (near - far)
        matrix[3, 2] = -1
        return matrix

    def project(self, points_m: FloatArray, size: Size) -> FloatArray:
        """Pixels (N, 2), y down, of world points (N, 3); NaN for points behind the eye."""
        seen = transform_points(self.T_eye_world, points_m)
        depth = np.where(seen[:, 2] < 0, -seen[:, 2], np.nan)
        flat = seen[:, :2] / depth[:, None] / _pixel_spread(size)
        return np.column_stack([size[0] / 2 + flat[:, 0], size[1] / 2 - flat[:, 1]])

    def ray(self, pixel: tuple[float, float], size: Size) -> Ray:
        """The line of sight through a pixel."""
        spread = _pixel_spread(size)
        seen = np.array([(pixel[0] - size[0] / 2) * spread, (size[1] / 2 - pixel[1]) * spread, -1.0])
        direction = self.axes.T @ seen
        return Ray(self.eye_m, direction / np.linalg.norm(direction), spread)

    def turned(self, azimuth_deg: float, elevation_deg: float) -> Camera:
        """Turned by so much about the centre; the eye goes no farther than straight above or below."""
        azimuth = (self.azimuth_deg + azimuth_deg + 180) % 360 - 180
        elevation = float(np.clip(self.elevation_deg + elevation_deg, -90, 90))
        return replace(self, azimuth_deg=azimuth, elevation_deg=elevation)

    def panned(self, right_px: float, down_px: float, size: Size) -> Camera:
        """Moved sideways so that what is in the centre moves by so many pixels."""
        step = self.distance_m * _pixel_spread(size)
        center = np.array(self.center_m) - step * (right_px * self.axes[0] - down_px * self.axes[1])
        return self.centered(center)

    def zoomed(self, factor: float) -> Camera:
        """As far away as before times a factor."""
        return replace(self, distance_m=float(np.clip(factor * self.distance_m, _NEAREST_M, _FARTHEST_M)))

    def zoomed_at(self, factor: float, pixel: tuple[float, float], size: Size) -> Camera:
        """As `zoomed`, and what is seen through a pixel, as far away as the centre, stays under it."""
        nearer = self.zoomed(factor)
        share = 1 - nearer.distance_m / self.distance_m
        return self.panned(share * (size[0] / 2 - pixel[0]), share * (size[1] / 2 - pixel[1]), size).zoomed(
            factor
        )

    def centered(self, point_m: FloatArray) -> Camera:
        """Looking at a point (3,) from the same side, as far away as before."""
        x, y, z = (float(value) for value in point_m)
        return replace(self, center_m=(x, y, z))

    def looking_from(self, direction: str) -> Camera:
        """Looking from one of `DIRECTIONS`."""
        azimuth, elevation = DIRECTIONS[direction]
        return replace(self, azimuth_deg=azimuth, elevation_deg=elevation)

    def blended(self, other: Camera, share: float) -> Camera:
        """Between this camera (0) and another one (1), turned the shorter way."""
        turn_deg = (other.azimuth_deg - self.azimuth_deg + 180) % 360 - 180
        center_m = (1 - share) * np.array(self.center_m) + share * np.array(other.center_m)
        return replace(
            self.centered(center_m),
            distance_m=self.distance_m ** (1 - share) * other.distance_m**share,
            azimuth_deg=(self.azimuth_deg + share * turn_deg + 180) % 360 - 180,
            elevation_deg=(1 - share) * self.elevation_deg + share * other.elevation_deg,
        )

    def fitted(self, points_m: FloatArray, size: Size) -> Camera:
        """From the same side, so near that points (N, 3) just fill a view of that size."""
        middle = (points_m.min(axis=0) + points_m.max(axis=0)) / 2
        half_view = np.array(size) * _pixel_spread(size) / 2
        camera = replace(self.centered(middle), distance_m=1.0)
        for _ in range(_ROUNDS):
            seen = (points_m - np.array(camera.center_m)) @ self.axes.T
            distance = float((seen[:, 2] + (np.abs(seen[:, :2]) / half_view).max(axis=1)).max())
            camera = replace(camera, distance_m=1.0).zoomed(_MARGIN * distance)
            on_screen = seen[:, :2] / (camera.distance_m - seen[:, 2:])
            aside = camera.distance_m * (on_screen.min(axis=0) + on_screen.max(axis=0)) / 2
            camera = camera.centered(np.array(camera.center_m) + aside @ self.axes[:2])
        return camera


def _pixel_spread(size: Size) -> float:
    """Width of a pixel a metre from the eye."""
    return float(2 * np.tan(np.radians(_FOV_DEG) / 2) / size[1])
