"""A clear way between two configurations: straight, through a few known places, or searched for."""

from __future__ import annotations

import time
from dataclasses import dataclass
from itertools import permutations

import numpy as np
import numpy.typing as npt

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.clearance import MotionScene
from core.motion.joint_path import STEP_RAD, check_path, sample_move, shorten
from core.motion.kinematics import nearest_turn, within_limits

MIN_CLEARANCE_M = 0.02
"""Room for what the model does not know: cables, factory calibration, a table that is not quite where it
should."""
_LEAP_RAD = 0.5
_COARSE_STEP_RAD = 3 * STEP_RAD
"""The search looks at every third degree; what it finds is checked at every one."""
_SEARCH_MARGIN_RAD = 0.8
_GOAL_SHARE = 0.1


@dataclass(frozen=True)
class RouteSettings:
    """How a way is searched for.

    Attributes:
        min_clearance_m: what must stay between any two things.
        via_rad: known places to pass, such as the home configuration, tried alone and in pairs.
        time_limit_s: of the random search; a way that is found in time does not depend on it.
        seed: of the random search.
    """

    min_clearance_m: float = MIN_CLEARANCE_M
    via_rad: tuple[tuple[float, ...], ...] = ()
    time_limit_s: float = 2.0
    seed: int = 0


def find_route(
    scene: MotionScene,
    start_rad: npt.ArrayLike,
    goal_rad: npt.ArrayLike,
    settings: RouteSettings = RouteSettings(),
) -> FloatArray:
    """Return configurations (M, 6) from start (6,) to goal (6,) whose straight joint moves are all clear.

    Straight if that is clear, else through the known places, else by RRT-connect (Kuffner and LaValle 2000)
    with shortcuts. The goal is reached at exactly the angles given, not at angles a turn away.

    Raises:
        MotionError: start or goal touches something, or no way was found in time.
    """
    start, goal = np.asarray(start_rad, dtype=float), np.asarray(goal_rad, dtype=float)
    _refuse_end(scene, start, "start", settings.min_clearance_m)
    _refuse_end(scene, goal, "goal", settings.min_clearance_m)
    straight = np.array([start, goal])
    blocked = check_path(scene, straight, settings.min_clearance_m).problem
    if blocked is None:
        return straight
    route = _through_known(scene, start, goal, settings)
    if route is None:
        route = _Search(scene, start, goal, settings).run()
    if route is None:
        raise MotionError(
            f"The arm found no clear way in {settings.time_limit_s:g} s (straight there was {blocked}); "
            "move the arm by hand to where it has room, or clear the cell."
        )
    return route


def _refuse_end(scene: MotionScene, joints: FloatArray, which: str, min_clearance_m: float) -> None:
    problem = check_path(scene, joints, min_clearance_m).problem
    if problem is not None:
        where = np.array2string(
            np.degrees(problem.joints_rad), precision=0, separator=", ", floatmode="fixed"
        )
        raise MotionError(
            f"The {which} of the move, at {where} degrees, is not allowed ({problem.what}, where "
            f"{min_clearance_m * 1000:.0f} mm must stay); choose another configuration or clear the cell."
        )


def _through_known(
    scene: MotionScene, start: FloatArray, goal: FloatArray, settings: RouteSettings
) -> FloatArray | None:
    """The shortest clear way through one or two known places, each taken a whole turn nearer where that
    helps.
    """
    vias = [nearest_turn(scene.arm, np.array(via), (start + goal) / 2) for via in settings.via_rad]
    chains = [chain for n in (1, 2) for chain in permutations(vias, n)]
    routes = [np.array([start, *chain, goal]) for chain in chains]
    for route in sorted(routes, key=path_length):
        if check_path(scene, route, settings.min_clearance_m).is_clear:
            return route
    return None


def path_length(route_rad: FloatArray) -> float:
    """How far the busiest joint turns, summed over the moves of a route (M, 6): in proportion to its
    duration.
    """
    return float(np.abs(np.diff(route_rad, axis=0)).max(axis=1, initial=0).sum())


class _Tree:
    """Configurations that can be reached from a root, and from where."""

    def __init__(self, root: FloatArray) -> None:
        self.nodes = [root]
        self.parents = [-1]

    def nearest(self, joints: FloatArray) -> int:
        return int(np.abs(np.array(self.nodes) - joints).max(axis=1).argmin())

    def add(self, joints: FloatArray, parent: int) -> int:
        self.nodes.append(joints)
        self.parents.append(parent)
        return len(self.nodes) - 1

    def way_from_root(self, node: int) -> list[FloatArray]:
        way = []
        while node >= 0:
            way.append(self.nodes[node])
            node = self.parents[node]
        return way[::-1]


class _Search:
    """RRT-connect: two trees that grow towards random configurations and then towards each other."""

    def __init__(
        self, scene: MotionScene, start: FloatArray, goal: FloatArray, settings: RouteSettings
    ) -> None:
        self._scene = scene
        self._settings = settings
        self._random = np.random.default_rng(settings.seed)
        self._start = start
        self._trees = [_Tree(start), _Tree(goal)]
        self._low, self._high = self._bounds(start, goal)
        self._deadline_s = time.monotonic() + settings.time_limit_s

    def run(self) -> FloatArray | None:
        """Return a way, shortened, or `None` when the time is up."""
        while time.monotonic() < self._deadline_s:
            growing, other = self._trees
            node = self._grow(growing, self._draw())
            if node is not None:
                meeting = self._connect(other, growing.nodes[node])
                if meeting is not None:
                    return self._join(growing, node, other, meeting)
            self._trees.reverse()
        return None

    def _bounds(self, start: FloatArray, goal: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Around start and goal, and half a turn where they are close: a whole turn of detour helps
        nobody.
        """
        middle, span = (start + goal) / 2, np.abs(goal - start) / 2
        half = np.maximum(span + _SEARCH_MARGIN_RAD, np.pi / 2)
        arm = self._scene.arm
        return np.maximum(middle - half, arm.lower_rad), np.minimum(middle + half, arm.upper_rad)

    def _draw(self) -> FloatArray:
        if self._random.random() < _GOAL_SHARE:
            return self._trees[1].nodes[0]
        return self._random.uniform(self._low, self._high)

    def _grow(self, tree: _Tree, towards: FloatArray) -> int | None:
        """One leap towards a configuration, if it is clear."""
        near = tree.nearest(towards)
        leap = towards - tree.nodes[near]
        size = float(np.abs(leap).max())
        there = towards if size <= _LEAP_RAD else tree.nodes[near] + leap * (_LEAP_RAD / size)
        return tree.add(there, near) if self._is_clear(tree.nodes[near], there) else None

    def _connect(self, tree: _Tree, target: FloatArray) -> int | None:
        """Leap after leap towards a node of the other tree; its index here if it is reached."""
        while (node := self._grow(tree, target)) is not None:
            if np.array_equal(tree.nodes[node], target):
                return node
        return None

    def _join(self, growing: _Tree, node: int, other: _Tree, meeting: int) -> FloatArray | None:
        way = growing.way_from_root(node) + other.way_from_root(meeting)[-2::-1]
        if not np.array_equal(way[0], self._start):
            way.reverse()
        shorter = shorten(self._scene, np.array(way), self._settings.min_clearance_m)
        return shorter if check_path(self._scene, shorter, self._settings.min_clearance_m).is_clear else None

    def _is_clear(self, start: FloatArray, goal: FloatArray) -> bool:
        samples = sample_move(start, goal, _COARSE_STEP_RAD)
        if not within_limits(self._scene.arm, samples).all():
            return False
        return bool(self._scene.clearance(samples).distance_m.min() >= self._settings.min_clearance_m)
