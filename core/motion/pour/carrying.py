"""Ways to carry the upright cup from above its station to where it is laid."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from core.geometry import FloatArray, IntArray
from core.motion.kinematics import TURN_RAD
from core.motion.pour.lattice import Lattice, clear_ways, place_grasps, place_of
from core.motion.pour.legs import ToolLeg
from core.motion.pour.scene import PourScene
from core.motion.pour.station import Grip, lifted_m

_COARSE_M, _COARSE_RAD = 0.04, np.radians(8)
_SAME = 1e-6
_ENTRIES = 12


@dataclass(frozen=True)
class Stretch:
    """A part of a way, from rest to rest, even in the coordinates of the lattice's places.

    Attributes:
        start: (4,) place: angle, radius, height, azimuth against the angle.
        goal: (4,) place.
    """

    start: FloatArray
    goal: FloatArray

    def poses(self, shares: FloatArray) -> FloatArray:
        """`T_base_grasp` (N, 4, 4) at shares (N,) of the way."""
        return place_grasps(self.start + shares[:, None] * (self.goal - self.start))

    @property
    def is_long(self) -> bool:
        """Whether it leads anywhere."""
        return bool(np.abs(self.goal - self.start).max() > _SAME)

    @property
    def length_m(self) -> float:
        """About how far the tool frame moves."""
        angle, radius, height, _ = np.abs(self.goal - self.start)
        return float(radius + height + angle * max(self.start[1], self.goal[1]))

    @property
    def turn_rad(self) -> float:
        """How far the hand turns."""
        way = self.goal - self.start
        return float(abs(way[0] + way[3]))

    @property
    def leg(self) -> ToolLeg:
        """The same with places near to each other."""
        return ToolLeg.of_length(self.poses, self.length_m, self.turn_rad)

    @property
    def coarse(self) -> FloatArray:
        """Poses (K, 4, 4) along it, some centimetres and degrees apart, without its beginning."""
        turn = np.abs(self.goal - self.start)[[0, 3]].max()
        n = int(max(np.ceil(self.length_m / _COARSE_M), np.ceil(turn / _COARSE_RAD), 1))
        return self.poses(np.linspace(0, 1, n + 1)[1:])


Carry = tuple[Stretch, ...]


class Carrying:
    """All ways from one grip to the places of a lattice; each is looked for once."""

    def __init__(self, scene: PourScene, grip: Grip, lattice: Lattice) -> None:
        """Find the places that can be entered from above the station, and from there all others."""
        self.grip = grip
        self._scene = scene
        self._lattice = lattice
        self._start = place_of(lifted_m(scene), grip.azimuth_rad)
        self._cost, self._before = lattice.ways_from(self._entries())
        self._found: dict[int, Carry | None] = {}

    @property
    def cost_rad(self) -> FloatArray:
        """What it costs (U,) to get to each place; inf where there is no way."""
        return self._cost

    def to(self, node: int) -> Carry | None:
        """A way to a place, clear at coarse steps: straight, up first, or over the lattice."""
        if node not in self._found:
            self._found[node] = self._find(node)
        return self._found[node]

    def _find(self, node: int) -> Carry | None:
        for way in straight_ways(self._start, self._lattice.places[node]):
            if self._is_clear(way):
                return way
        corners = self._corners(node)
        for k in range(len(corners) - 1):
            if not self._is_clear((Stretch(corners[k], corners[k + 1]),)):
                return None
        return self._shortened(corners)

    def _entries(self) -> IntArray:
        """Places that can be reached from above the station, the nearest few."""
        places = self._lattice.places
        apart = _whole_turns(places - self._start)
        near = np.argsort(np.abs(apart) @ np.array([1.0, 3.0, 3.0, 0.5]), kind="stable")[:_ENTRIES]
        entered = [int(k) for k in near if self._is_clear((Stretch(self._start, self._start + apart[k]),))]
        return np.array(entered, dtype=np.int64)

    def _corners(self, node: int) -> list[FloatArray]:
        """Places from above the station over the lattice, each within half a turn of the one before."""
        nodes = [node]
        while (before := int(self._before[nodes[-1]])) >= 0:
            nodes.append(before)
        corners = [self._start]
        for k in nodes[::-1]:
            corners.append(corners[-1] + _whole_turns(self._lattice.places[k] - corners[-1]))
        return corners

    def _shortened(self, corners: list[FloatArray]) -> Carry:
        """From each corner straight to the farthest one that is clear."""
        way: list[Stretch] = []
        here = 0
        while here < len(corners) - 1:
            there = next(
                k
                for k in range(len(corners) - 1, here, -1)
                if k == here + 1 or self._is_clear((Stretch(corners[here], corners[k]),))
            )
            way.append(Stretch(corners[here], corners[there]))
            here = there
        return tuple(way)

    def _is_clear(self, way: Carry) -> bool:
        poses = np.concatenate([stretch.coarse for stretch in way])
        return bool(clear_ways(self._scene, self._lattice.branch, poses[None]).all())


def straight_ways(start: FloatArray, goal: FloatArray) -> Iterator[Carry]:
    """Ways between two places (4,): straight, or up first and then straight."""
    end = start + _whole_turns(goal - start)
    yield (Stretch(start, end),)
    corner = start.copy()
    corner[2] = end[2]
    yield tuple(way for way in (Stretch(start, corner), Stretch(corner, end)) if way.is_long)


def _whole_turns(way: FloatArray) -> FloatArray:
    """Ways (..., 4) between places with both angles the shorter way round."""
    turns = np.zeros_like(way)
    turns[..., [0, 3]] = TURN_RAD * np.round(way[..., [0, 3]] / TURN_RAD)
    return np.asarray(way - turns)
