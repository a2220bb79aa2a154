"""What families are built of: hollows between rings, blocks of heights, and what they hold, exactly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray, IntArray, transform_points
from core.mesh import TriangleMesh
from core.mesh_topology import join
from hardware.simulation.families.truth import Form, Gap, Hole
from hardware.simulation.objects import (
    N_SIDES,
    Point,
    loft,
    rounded_rectangle,
    smooth,
    vessel_profile,
)

SUNK_M = 0.0002
"""How deep one body stands in another: surfaces that only touch would be neither joined nor apart."""
_EDGE_M = 0.0003
"""Run of a block's steps: upright enough, and still a height at every place."""


@dataclass(frozen=True)
class Draw:
    """What one member of a family is drawn by.

    Attributes:
        sweep: from 0 to 1, spread evenly over the members: for what grows from member to member.
        random: for everything else.
    """

    sweep: float
    random: np.random.Generator

    def swept(self, low: float, high: float) -> float:
        """Return the member's place between two values."""
        return low + (high - low) * self.sweep

    def between(self, low: float, high: float) -> float:
        """Draw a value, evenly on a logarithmic scale: half as large is as likely as twice as large."""
        return float(np.exp(self.random.uniform(np.log(low), np.log(high))))

    def count(self, low: int, high: int) -> int:
        """Draw a whole number, `high` included."""
        return int(self.random.integers(low, high + 1))

    def happens(self, chance: float) -> bool:
        """Draw yes or no."""
        return bool(self.random.random() < chance)


@dataclass(frozen=True)
class Hollow:
    """A body between an outer and an inner surface of rings that meet at the rim.

    Attributes:
        outer_m: (R, K, 3) rings from the foot up to the rim's top.
        inner_m: (S, K, 3) rings from there down to the floor.
        wall_m: its least thickness.
        through_m: (T, K, 3) rings from the floor down to the foot, of a hole; none if it is tight.
    """

    outer_m: FloatArray
    inner_m: FloatArray
    wall_m: float
    through_m: FloatArray | None = None

    @property
    def mesh(self) -> TriangleMesh:
        """Its closed surface."""
        if self.through_m is None:
            return loft(np.concatenate([self.outer_m, self.inner_m]))
        return loft(np.concatenate([self.outer_m, self.inner_m, self.through_m]), closed=True)

    @property
    def rim_m(self) -> float:
        """Height of the lowest place of the rim's top."""
        return float(self.inner_m[0, :, 2].min())

    @property
    def floor_m(self) -> float:
        """Height of the hollow's deepest place."""
        return float(self.inner_m[..., 2].min())

    @property
    def capacity_m3(self) -> float:
        """Volume of the hollow below the lowest place of the rim."""
        return volume_below_m3(loft(self.inner_m[::-1]), self.rim_m)

    @property
    def mouth_m(self) -> float:
        """Width of the narrowest ring between the rim and where it is widest."""
        widths = (self.inner_m.max(axis=1) - self.inner_m.min(axis=1))[:, :2].min(axis=1)
        return float(widths[: int(widths.argmax()) + 1].min())

    def outer_volume_below_m3(self, level_m: float) -> float:
        """Volume of body and hollow together below a height."""
        return volume_below_m3(loft(np.concatenate([self.outer_m, self.inner_m[:1]])), level_m)

    def moved(self, T_target_source: FloatArray) -> Hollow:
        """Return it in another frame."""
        return replace(
            self,
            outer_m=transform_points(T_target_source, self.outer_m),
            inner_m=transform_points(T_target_source, self.inner_m),
        )

    def stretched(self, factor: float) -> Hollow:
        """Stretch it along x by a factor of at least 1; walls grow where they do."""
        factors = np.array([factor, 1.0, 1.0])
        return replace(self, outer_m=self.outer_m * factors, inner_m=self.inner_m * factors)

    def form(self, *others: TriangleMesh, mouth_m: float | None = None, hole: Hole | None = None) -> Form:
        """Return it as an object, with other bodies that take none of its room."""
        return Form(
            join((self.mesh, *others)) if others else self.mesh,
            self.capacity_m3,
            max(self.rim_m - self.floor_m, 0.0),
            Gap(self.mouth_m if mouth_m is None else mouth_m),
            self.wall_m,
            hole,
        )


def vessel(outside: Sequence[Point], wall_m: float, floor_m: float) -> Hollow:
    """A turned vessel of even wall; `outside` are (radius, height) from the foot to the rim."""
    outer, inner = vessel_profile(list(outside), wall_m, floor_m)
    return profiled(outer, inner, wall_m)


def profiled(outer: Sequence[Point], inner: Sequence[Point], wall_m: float) -> Hollow:
    """Revolve profiles of (radius, height), from the foot to the rim's top and from there to the floor."""
    return Hollow(revolved(outer), revolved(inner), wall_m)


def revolved(profile: Sequence[Point]) -> FloatArray:
    """Return the rings (R, K, 3) of a profile of (radius, height)."""
    angles = np.linspace(0, 2 * np.pi, N_SIDES, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles), np.ones(N_SIDES)])
    return np.array([circle * [radius, radius, height] for radius, height in profile])


def tub(size_m: Sequence[float], wall_m: float, floor_m: float, corner_m: float, lean_m: float = 0) -> Hollow:
    """An open box of (length, width, height) at the rim, with rounded corners.

    Args:
        size_m: outside.
        wall_m: thickness of the walls, measured level.
        floor_m: thickness of the floor.
        corner_m: radius of its upright edges.
        lean_m: how much shorter it is on each side at z = 0.
    """
    length, width, height = size_m
    at_floor = lean_m * (1 - floor_m / height)

    def ring(shorter_m: float, z_m: float) -> FloatArray:
        outline = rounded_rectangle(length - 2 * shorter_m, width - 2 * shorter_m, corner_m)
        return np.column_stack([outline, np.full(len(outline), z_m)])

    outer = [ring(lean_m, 0.0), ring(0.0, height)]
    inner = [ring(wall_m, height), ring(wall_m + at_floor, floor_m)]
    return Hollow(np.array(outer), np.array(inner), min(wall_m, floor_m))


def straight(foot_m: float, rim_m: float, height_m: float) -> list[Point]:
    """Outline of a cylinder or cone, with a slightly rounded foot."""
    bevel = min(0.03 * height_m, 0.1 * foot_m)
    heights = np.linspace(bevel, height_m, 24)
    radii = foot_m + (rim_m - foot_m) * heights / height_m
    return [(foot_m - bevel, 0.0), *zip(radii.tolist(), heights.tolist(), strict=True)]


def curved(corners: Sequence[Point], n: int = 60) -> list[Point]:
    """A monotone curve of radius over height through (radius, height) corners."""
    return smooth(list(corners), n)


def slab(size_m: Sequence[float], at_m: Sequence[float]) -> TriangleMesh:
    """A box of (length, width, height) whose underside has its middle at (x, y, z)."""
    length, width, height = size_m
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [length / 2, width / 2]
    rings = [np.column_stack([corners, np.full(4, z)]) for z in (0.0, height)]
    return loft(rings).translated(np.array(at_m, dtype=float))


def disc(radius_m: float, low_m: float, high_m: float) -> TriangleMesh:
    """A round plate from one height to another."""
    return loft(revolved([(radius_m, low_m), (radius_m, high_m)]))


def standing(mesh: TriangleMesh) -> TriangleMesh:
    """Return it resting on z = 0."""
    return mesh.translated(np.array([0.0, 0.0, -mesh.aabb_min_m[2]]))


@dataclass(frozen=True)
class Block:
    """A body with a level underside and a height at every place (x, y).

    Attributes:
        xs_m: (N,) ascending.
        ys_m: (M,) ascending.
        heights_m: (N, M), all above 0.
    """

    xs_m: FloatArray
    ys_m: FloatArray
    heights_m: FloatArray

    @classmethod
    def of_cells(cls, edges_x_m: npt.ArrayLike, edges_y_m: npt.ArrayLike, heights_m: npt.ArrayLike) -> Block:
        """Cells (N, M), each level, between edges (N + 1,) and (M + 1,), with upright steps between them."""
        xs, ys = _doubled(edges_x_m), _doubled(edges_y_m)
        return cls(xs, ys, np.asarray(heights_m, dtype=float).repeat(2, axis=0).repeat(2, axis=1))

    @property
    def mesh(self) -> TriangleMesh:
        """Its closed surface."""
        top = self._top()
        n_x, n_y = self.heights_m.shape
        n = n_x * n_y
        index = np.arange(n).reshape(n_x, n_y)
        border = np.concatenate([index[:-1, 0], index[-1, :-1], index[:0:-1, -1], index[0, :0:-1]])
        after = np.roll(border, -1)
        sides = np.concatenate(
            [
                np.column_stack([border + n, after + n, after]),
                np.column_stack([border + n, after, border]),
            ]
        )
        below = top.vertices_m * [1, 1, 0]
        faces = np.concatenate([top.faces, top.faces[:, ::-1] + n, sides])
        return TriangleMesh(np.concatenate([top.vertices_m, below]), faces)

    def capacity_m3(self, level_m: float) -> float:
        """Volume over it below a height that its border nowhere falls below."""
        return -volume_below_m3(self._top(), level_m)

    def _top(self) -> TriangleMesh:
        x, y = np.meshgrid(self.xs_m, self.ys_m, indexing="ij")
        points = np.stack([x, y, self.heights_m], axis=-1).reshape(-1, 3)
        return TriangleMesh(points, _grid_faces(*self.heights_m.shape))


def _grid_faces(n_x: int, n_y: int) -> IntArray:
    """Two triangles for each cell of a grid of (N, M) points, turned upwards."""
    index = np.arange(n_x * n_y).reshape(n_x, n_y)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    return np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def _doubled(edges_m: npt.ArrayLike) -> FloatArray:
    """Edges of cells (N + 1,) as both ends of each cell (2 N,), a step's run apart."""
    edges = np.asarray(edges_m, dtype=float)
    ends = np.stack([edges[:-1] + _EDGE_M / 2, edges[1:] - _EDGE_M / 2], axis=1).ravel()
    ends[[0, -1]] = edges[[0, -1]]
    return ends


def volume_below_m3(surface: TriangleMesh, level_m: float) -> float:
    """Return the volume that a closed surface encloses below a height, exactly.

    By the divergence theorem for the field (0, 0, z - level), which is zero on the water's own surface: it
    need not be there, and upright sides may be missing too. Negative if the faces look inwards.
    """
    corners = surface.vertices_m[surface.faces]
    turned = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] / 2
    return float(turned @ _mean_below(corners[..., 2] - level_m))


def _mean_below(heights_m: FloatArray) -> FloatArray:
    """Mean over each triangle of its height where that is negative, and 0 elsewhere; from (F, 3) corners."""
    low, middle, high = np.sort(heights_m, axis=1).T
    mean: FloatArray = np.where(high <= 0, (low + middle + high) / 3, 0.0)
    tip = (low < 0) & (middle >= 0) & (high > 0)
    share = low[tip] ** 2 / ((low - middle) * (low - high))[tip]
    mean[tip] = share * low[tip] / 3
    cut = (middle < 0) & (high > 0)
    share = high[cut] ** 2 / ((high - low) * (high - middle))[cut]
    mean[cut] = (low + middle + high)[cut] / 3 - share * high[cut] / 3
    return mean
