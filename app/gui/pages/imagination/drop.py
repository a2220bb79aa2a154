"""An imagined drop as the page shows it: read in a thread, cut into phases, with its moments. Qt-free."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from app.gui.pages.photographed import in_colors
from app.gui.views.scene import PreparedMesh, prepare_mesh
from app.gui.views.scene.occlusion import surface_points_m
from app.gui.views.scene.shapes import Shape
from core.geometry import FloatArray, make_pose, rotation_y, rotation_z
from core.imagination.capacity.result import Capacity
from core.imagination.particle_shape import particle_extents_m
from core.imagination.recording import Float32Array, Recording
from core.imagination.rendering.replay import make_replay, standing
from core.imagination.rendering.shapes import candy_mesh
from core.imagination.results import Containability, Drop
from core.imagination.retention.result import Retention
from core.mesh import TriangleMesh
from core.parameters.bodies import ParticleParameters
from core.parameters.imagination import ContainabilityParameters
from core.pipeline.session_view import SessionView

PhaseKey = Literal["drop", "tilt_x", "tilt_y", "push"]
N_PUSHES = 4
_OUTLINE_DIRECTIONS = 180
_N_CASTERS = 15_000
_MARGIN, _LEAST_SIZES, _MOST_SIZES = 1.8, 3.0, 9.0
"""The ground reaches so far beyond what fell; at least, and at most, so many times half the object's size."""


@dataclass(frozen=True)
class Phase:
    """A stretch of the drop.

    Attributes:
        key: which one.
        begin_s: since the start.
        end_s: since the start.
        n_inside: candies within the object's bounding box at its end.
    """

    key: PhaseKey
    begin_s: float
    end_s: float
    n_inside: int


class Moments:
    """Candies and body at any time of a recording; fast enough for every frame.

    Attributes:
        duration_s: time of the last moment.
    """

    def __init__(self, recording: Recording) -> None:
        self._recording = recording
        self.duration_s = float(recording.time_s[-1])

    def positions_m(self, time_s: float) -> Float32Array:
        """Return the candies (N, 3); NaN where one is absent at the moment before or after."""
        before, after, share = self._around(time_s)
        positions = self._recording.positions_m
        between: Float32Array = positions[before] + share * (positions[after] - positions[before])
        return between

    def quaternions(self, time_s: float) -> Float32Array:
        """Return the candies' orientations (N, 4), (x, y, z, w); not of length one between two moments."""
        before, after, share = self._around(time_s)
        first, second = self._recording.quaternions[before], self._recording.quaternions[after]
        is_opposite = np.einsum("ij,ij->i", first, second) < 0
        nearer = np.where(is_opposite[:, None], -second, second)
        between: Float32Array = first + share * (nearer - first)
        return between

    def T_world_body(self, time_s: float) -> FloatArray:
        """Return the body's pose (4, 4); interpolated entry by entry: it rotates little."""
        before, after, share = self._around(time_s)
        poses = self._recording.T_world_body
        between: FloatArray = ((1 - share) * poses[before] + share * poses[after]).astype(float)
        return between

    def _around(self, time_s: float) -> tuple[int, int, np.float32]:
        """The moments before and after a time, and how far it is between them, 0 to 1."""
        times_s = self._recording.time_s
        after = int(np.clip(np.searchsorted(times_s, time_s), 1, max(len(times_s) - 1, 1)))
        if len(times_s) == 1:
            return 0, 0, np.float32(0)
        step_s = times_s[after] - times_s[after - 1]
        share = np.clip((time_s - times_s[after - 1]) / step_s, 0, 1)
        return after - 1, after, np.float32(share)


@dataclass(frozen=True)
class DropKey:
    """Which files are to be shown: the session's folder and digests, empty for none."""

    folder: Path
    containability: str
    judgement: str
    collision: str
    pouring: str
    retention: str


@dataclass(frozen=True, eq=False)
class ShownBody:
    """The object before anything was dropped on it.

    Attributes:
        body: the surface that the physics knows.
        casters_m: (n, 3) points all over it, for its shadow.
        center_m: (3,) below its middle, on the ground.
        ground_radius_m: half the ground's side.
    """

    body: PreparedMesh
    casters_m: FloatArray
    center_m: FloatArray
    ground_radius_m: float


@dataclass(frozen=True, eq=False)
class ShownDrop:
    """A drop, ready to be replayed.

    Attributes:
        digest: of the drop.
        drop: what became of the candies.
        containability: the verdict; none as long as it is not known what the object holds.
        capacity: how much the object holds; none if it was not imagined.
        retention: how far the object may be tilted; none if it was not imagined.
        settings: it was imagined with.
        particle: the candy.
        seed: of all its randomness.
        seconds: it took.
        moments: candies and object at any time; what is lost lies where it passed the ground.
        phases: what happened when.
        n_on_top: candies that lie on the object at the end, but not in its bounding box.
        body: the surface that the physics knew.
        candy: what the physics took a candy for, about its centre.
        ground_m: height of the ground, on which the object stands.
        casters_m: (n, 3) points all over it, for its shadow.
        ground_radius_m: wide enough for all that fell.
        outline_m: (n, 2) the object from above, its hull.
        indents_m: distances of the pivots from the footprint's centre; empty without pours.
    """

    digest: str
    drop: Drop
    containability: Containability | None
    capacity: Capacity | None
    retention: Retention | None
    settings: ContainabilityParameters
    particle: ParticleParameters
    seed: int
    seconds: float
    moments: Moments
    phases: tuple[Phase, ...]
    n_on_top: int
    body: PreparedMesh
    candy: Shape
    ground_m: float
    casters_m: FloatArray
    ground_radius_m: float
    outline_m: FloatArray
    indents_m: tuple[float, ...]


def key_of(view: SessionView) -> DropKey:
    """Look up the stages' digests."""
    stages = ("containability", "judgement", "collision", "pouring", "retention")
    records = [view.finished.get(stage) for stage in stages]
    digests = ["" if record is None else record.digest for record in records]
    return DropKey(view.session.path, *digests)


def load(key: DropKey) -> ShownDrop | ShownBody | None:
    """Read a session's drop, or its object alone if nothing was dropped; none if there is no object.

    Raises:
        SessionError: a file is damaged, or of another version.
    """
    from core.collision import CollisionModel

    if not key.collision:
        return None
    view = SessionView.of(key.folder)
    surface = CollisionModel.load(view.session.folder("collision")).surface
    body = in_colors(prepare_mesh(surface.vertices_m, surface.faces, is_shaded=True), surface, view)
    casters_m = surface_points_m(surface.vertices_m, surface.faces, _N_CASTERS)
    drop = view.drop
    if drop is None:
        return _standing_alone(surface, body, casters_m)
    parameters, judgement = view.parameters_of("containability"), view.judgement
    settings, particle = parameters.containability, parameters.particle
    recording, ground_m = standing(drop.recording, surface)
    candy = candy_mesh(particle)
    replay = make_replay(recording, drop.retained, ground_m, particle_extents_m(particle))
    return ShownDrop(
        digest=key.containability,
        drop=drop,
        containability=None if judgement is None else judgement.of(drop),
        capacity=None if judgement is None else judgement.capacity,
        retention=view.retention,
        settings=settings,
        particle=particle,
        seed=parameters.seed,
        seconds=sum(
            view.records[name].seconds for name in ("containability", "judgement") if name in view.records
        ),
        moments=Moments(replay.recording),
        phases=phases_of(drop, settings),
        n_on_top=_n_on_top(drop),
        body=body,
        casters_m=casters_m,
        candy=(candy.vertices_m, candy.faces),
        ground_m=ground_m,
        ground_radius_m=_ground_radius_m(surface, replay.recording.positions_m[-1]),
        outline_m=_outline_m(surface),
        indents_m=() if view.pours is None else view.pours.indent_m,
    )


def _standing_alone(surface: TriangleMesh, body: PreparedMesh, casters_m: FloatArray) -> ShownBody:
    middle_m = (surface.aabb_min_m + surface.aabb_max_m) / 2
    center_m = np.array([*middle_m[:2], surface.aabb_min_m[2]])
    return ShownBody(body, casters_m, center_m, _ground_radius_m(surface, np.empty((0, 3), np.float32)))


def _n_on_top(drop: Drop) -> int:
    """Fallen candies are no longer recorded, or are still falling."""
    heights_m = drop.recording.positions_m[-1, ~drop.retained, 2]
    with np.errstate(invalid="ignore"):
        return int((heights_m >= drop.aabb_m[1, 2]).sum())


def _ground_radius_m(surface: TriangleMesh, ends_m: Float32Array) -> float:
    """Around the object's middle."""
    middle_m = (surface.aabb_min_m + surface.aabb_max_m)[:2] / 2
    size_m = float(np.linalg.norm(surface.extents_m[:2])) / 2
    away_m = np.linalg.norm(ends_m[:, :2] - middle_m, axis=1)
    farthest_m = float(away_m[np.isfinite(away_m)].max(initial=0.0))
    return min(max(_MARGIN * farthest_m, _LEAST_SIZES * size_m), _MOST_SIZES * size_m)


def _outline_m(surface: TriangleMesh) -> FloatArray:
    """The hull (n, 2) from above: the farthest vertex in each direction."""
    angles = np.linspace(0, 2 * np.pi, _OUTLINE_DIRECTIONS, endpoint=False)
    points_m = surface.vertices_m[:, :2]
    farthest = (points_m @ np.array([np.cos(angles), np.sin(angles)])).argmax(axis=0)
    outline: FloatArray = points_m[farthest]
    return outline


def phases_of(drop: Drop, settings: ContainabilityParameters) -> tuple[Phase, ...]:
    """Return the phases (Sec. III-A, Fig. 3a) that take time, in their order."""
    lengths: dict[PhaseKey, float] = {
        "drop": settings.drop_s,
        "tilt_x": settings.rotation_s,
        "tilt_y": settings.rotation_s,
        "push": N_PUSHES * settings.translation_s,
    }
    phases, begin_s = [], 0.0
    for key, length_s in lengths.items():
        if length_s > 0:
            n_inside = _n_inside(drop, begin_s + length_s)
            phases.append(Phase(key, begin_s, begin_s + length_s, n_inside))
            begin_s += length_s
    return tuple(phases)


def push_of(settings: ContainabilityParameters, since_s: float) -> str:
    """Return the direction of the push, `since_s` after the first began."""
    index = min(int(since_s / settings.translation_s), N_PUSHES - 1)
    return ("+x", "-x", "+y", "-y")[index]


def _n_inside(drop: Drop, time_s: float) -> int:
    recording = drop.recording
    positions_m = recording.positions_m[int(np.abs(recording.time_s - time_s).argmin())]
    low_m, high_m = drop.aabb_m
    with np.errstate(invalid="ignore"):  # NaN: fallen and gone
        return int(((positions_m > low_m) & (positions_m < high_m)).all(axis=1).sum())


def tilted_pose(points_m: FloatArray, ground_m: float, tilt_rad: float, toward_rad: float) -> FloatArray:
    """Return the pose (4, 4) of an object that is tilted towards a side and stands on the ground again.

    Args:
        points_m: (n, 3) of its surface as it was scanned.
        ground_m: height of the ground.
        tilt_rad: how far.
        toward_rad: the side that sinks, against the x-axis.
    """
    rotation = rotation_z(toward_rad) @ rotation_y(tilt_rad) @ rotation_z(-toward_rad)
    middle_m = (points_m.min(axis=0) + points_m.max(axis=0)) / 2
    translation_m = middle_m - rotation @ middle_m
    lowest_m = float((points_m @ rotation.T + translation_m)[:, 2].min())
    translation_m[2] += ground_m - lowest_m
    return make_pose(rotation, translation_m)
