"""Paths of straight joint moves: whether one is clear, and the search for one that is."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from itertools import permutations

import numpy as np
import numpy.typing as npt

from core.errors import MotionError
from core.geometry import FloatArray
from core.motion.arm_models import JOINT_NAMES
from core.motion.clearance import MotionScene
from core.motion.kinematics import nearest_turn, within_limits

STEP_RAD = np.radians(1.0)
"""No joint moves farther between two samples of a path: at a reach of 0.95 m, 17 mm at the flange."""
MIN_CLEARANCE_M = 0.02
"""Margin for what the model does not know: cables, factory calibration, a table that is slightly off."""
_LEAP_RAD = 0.5
_COARSE_STEP_RAD = 3 * STEP_RAD
"""The search checks every third degree; what it finds is checked at every one."""
_SEARCH_MARGIN_RAD = 0.8
_GOAL_SHARE = 0.1


@dataclass(frozen=True)
class PathProblem:
    """The first configuration on a path that the arm must not take.

    Attributes:
        between: names of the two that are too close, or the joint and "its limit".
        segment: index of the straight move, from 0.
        share: of the move that is clear, 0 to 1.
        joints_rad: (6,) the configuration there.
        distance_m: the clearance there, negative if the two overlap; none at a limit.
    """

    between: tuple[str, str]
    segment: int
    share: float
    joints_rad: FloatArray
    distance_m: float | None

    @property
    def what(self) -> str:
        """The problem without its position on the path."""
        if self.distance_m is None:
            return f"the {self.between[0]} joint is beyond its limit"
        gap = f"{self.distance_m * 1000:.0f} mm" if self.distance_m > 0 else "no clearance"
        return f"{gap} between {self.between[0]} and {self.between[1]}"

    def __str__(self) -> str:
        return f"{self.what} {self.share:.0%} along move {self.segment + 1}"


@dataclass(frozen=True)
class PathCheck:
    """Whether a path may be executed.

    Attributes:
        problem: the first one, or `None`.
        clearance_m: the smallest distance on the path, up to and including the problem; inf if none was
            measured.
    """

    problem: PathProblem | None
    clearance_m: float

    @property
    def is_clear(self) -> bool:
        """Whether there is no problem."""
        return self.problem is None


def check_path(scene: MotionScene, configurations_rad: npt.ArrayLike, min_clearance_m: float) -> PathCheck:
    """Check straight joint moves through configurations (M, 6), M at least 1, sampled at most 1 degree apart.

    Args:
        scene: the arm and its surroundings.
        configurations_rad: (M, 6) to pass, in this order.
        min_clearance_m: required between any two things.
    """
    corners = np.atleast_2d(np.asarray(configurations_rad, dtype=float))
    smallest = np.inf
    for k in range(max(len(corners) - 1, 1)):
        samples = sample_move(corners[k], corners[min(k + 1, len(corners) - 1)])
        beyond = _beyond_limits(scene, samples, k)
        if beyond is not None:
            return PathCheck(beyond, smallest)
        clearance = scene.clearance(samples)
        near = clearance.distance_m < min_clearance_m
        if near.any():
            i = int(near.argmax())
            distance = float(clearance.distance_m[i])
            share = i / max(len(samples) - 1, 1)
            problem = PathProblem(clearance.nearest(i), k, share, samples[i], distance)
            return PathCheck(problem, min(smallest, float(clearance.distance_m[: i + 1].min())))
        smallest = min(smallest, float(clearance.distance_m.min()))
    return PathCheck(None, smallest)


def sample_move(start_rad: FloatArray, goal_rad: FloatArray, step_rad: float = STEP_RAD) -> FloatArray:
    """Configurations (K, 6) on a straight joint move, both ends included, at most a step apart."""
    n_steps = int(np.ceil(np.abs(goal_rad - start_rad).max() / step_rad))
    return np.asarray(start_rad + np.linspace(0, 1, n_steps + 1)[:, None] * (goal_rad - start_rad))


def shorten(scene: MotionScene, path_rad: FloatArray, min_clearance_m: float) -> FloatArray:
    """Leave out corners of a clear path (M, 6) where the straight moves stay clear."""

    def is_clear(here: int, there: int) -> bool:
        return check_path(scene, path_rad[[here, there]], min_clearance_m).is_clear

    return path_rad[shortcuts(len(path_rad), is_clear)]


def shortcuts(n: int, is_clear: Callable[[int, int], bool]) -> list[int]:
    """From each of `n` corners, go on to the farthest that is reached directly; return those passed."""
    corners = [0]
    while corners[-1] < n - 1:
        here = corners[-1]
        farthest = (there for there in range(n - 1, here, -1) if there == here + 1 or is_clear(here, there))
        corners.append(next(farthest))
    return corners


def _beyond_limits(scene: MotionScene, samples: FloatArray, segment: int) -> PathProblem | None:
    inside = within_limits(scene.arm, samples)
    if inside.all():
        return None
    i = int((~inside).any(axis=1).argmax())
    joint = JOINT_NAMES[int((~inside[i]).argmax())]
    share = i / max(len(samples) - 1, 1)
    return PathProblem((joint, "its limit"), segment, share, samples[i], None)


@dataclass(frozen=True)
class RouteSettings:
    """How a path is searched for.

    Attributes:
        min_clearance_m: required between any two things.
        via_rad: known via-points, such as the home configuration, tried alone and in pairs.
        time_limit_s: of the random search; a path that is found in time does not depend on it.
    """

    min_clearance_m: float = MIN_CLEARANCE_M
    via_rad: tuple[tuple[float, ...], ...] = ()
    time_limit_s: float = 2.0


def find_route(
    scene: MotionScene,
    start_rad: npt.ArrayLike,
    goal_rad: npt.ArrayLike,
    settings: RouteSettings = RouteSettings(),
) -> FloatArray:
    """Return configurations (M, 6) from start (6,) to goal (6,) whose straight joint moves are all clear.

    Straight if that is clear, else through the known via-points, else by RRT-connect (Kuffner and LaValle
    2000) with shortcuts. The goal is reached at exactly the given angles, not at angles a turn away.

    Raises:
        MotionError: start or goal is not clear, or no path was found in time.
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
            f"No clear path was found in {settings.time_limit_s:g} s (on the straight one: {blocked}); "
            "jog the arm to a place with more clearance, or clear the cell."
        )
    return route


def _refuse_end(scene: MotionScene, joints: FloatArray, which: str, min_clearance_m: float) -> None:
    problem = check_path(scene, joints, min_clearance_m).problem
    if problem is not None:
        where = np.array2string(
            np.degrees(problem.joints_rad), precision=0, separator=", ", floatmode="fixed"
        )
        required = (
            "" if problem.distance_m is None else f", where {min_clearance_m * 1000:.0f} mm are required"
        )
        raise MotionError(
            f"The {which} of the move, at {where} degrees, is not allowed ({problem.what}{required}); choose "
            "another configuration or clear the cell."
        )


def _through_known(
    scene: MotionScene, start: FloatArray, goal: FloatArray, settings: RouteSettings
) -> FloatArray | None:
    """The shortest clear path through one or two via-points, each by whole turns as near as possible."""
    vias = [nearest_turn(scene.arm, np.array(via), (start + goal) / 2) for via in settings.via_rad]
    chains = [chain for n in (1, 2) for chain in permutations(vias, n)]
    routes = [np.array([start, *chain, goal]) for chain in chains]
    for route in sorted(routes, key=path_length):
        if check_path(scene, route, settings.min_clearance_m).is_clear:
            return route
    return None


def path_length(route_rad: FloatArray) -> float:
    """The largest joint displacements of a route's (M, 6) moves, summed: proportional to its duration."""
    return float(np.abs(np.diff(route_rad, axis=0)).max(axis=1, initial=0).sum())


class _Tree:
    """Configurations that can be reached from a root, with their parents."""

    def __init__(self, root: FloatArray) -> None:
        self.nodes = [root]
        self.parents = [-1]

    def nearest(self, joints: FloatArray) -> int:
        return int(np.abs(np.array(self.nodes) - joints).max(axis=1).argmin())

    def add(self, joints: FloatArray, parent: int) -> int:
        self.nodes.append(joints)
        self.parents.append(parent)
        return len(self.nodes) - 1

    def path_from_root(self, node: int) -> list[FloatArray]:
        path = []
        while node >= 0:
            path.append(self.nodes[node])
            node = self.parents[node]
        return path[::-1]


class _Search:
    """RRT-connect: two trees that grow towards random configurations and then towards each other."""

    def __init__(
        self, scene: MotionScene, start: FloatArray, goal: FloatArray, settings: RouteSettings
    ) -> None:
        self._scene = scene
        self._settings = settings
        self._random = np.random.default_rng(0)
        self._start = start
        self._trees = [_Tree(start), _Tree(goal)]
        self._low, self._high = self._bounds(start, goal)
        self._deadline_s = time.monotonic() + settings.time_limit_s

    def run(self) -> FloatArray | None:
        """Return a path, shortened, or `None` when the time is up."""
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
        """Around start and goal, and half a turn where they are close: longer detours are useless."""
        middle, span = (start + goal) / 2, np.abs(goal - start) / 2
        half = np.maximum(span + _SEARCH_MARGIN_RAD, np.pi / 2)
        arm = self._scene.arm
        return np.maximum(middle - half, arm.lower_rad), np.minimum(middle + half, arm.upper_rad)

    def _draw(self) -> FloatArray:
        if self._random.random() < _GOAL_SHARE:
            return self._trees[1].nodes[0]
        return self._random.uniform(self._low, self._high)

    def _grow(self, tree: _Tree, towards: FloatArray) -> int | None:
        """One step towards a configuration, if it is clear."""
        near = tree.nearest(towards)
        leap = towards - tree.nodes[near]
        size = float(np.abs(leap).max())
        there = towards if size <= _LEAP_RAD else tree.nodes[near] + leap * (_LEAP_RAD / size)
        return tree.add(there, near) if self._is_clear(tree.nodes[near], there) else None

    def _connect(self, tree: _Tree, target: FloatArray) -> int | None:
        """Step by step towards a node of the other tree; its index here if it is reached."""
        while (node := self._grow(tree, target)) is not None:
            if np.array_equal(tree.nodes[node], target):
                return node
        return None

    def _join(self, growing: _Tree, node: int, other: _Tree, meeting: int) -> FloatArray | None:
        path = growing.path_from_root(node) + other.path_from_root(meeting)[-2::-1]
        if not np.array_equal(path[0], self._start):
            path.reverse()
        shorter = shorten(self._scene, np.array(path), self._settings.min_clearance_m)
        return shorter if check_path(self._scene, shorter, self._settings.min_clearance_m).is_clear else None

    def _is_clear(self, start: FloatArray, goal: FloatArray) -> bool:
        samples = sample_move(start, goal, _COARSE_STEP_RAD)
        if not within_limits(self._scene.arm, samples).all():
            return False
        return bool(self._scene.clearance(samples).distance_m.min() >= self._settings.min_clearance_m)
