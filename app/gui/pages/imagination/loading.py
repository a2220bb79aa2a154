"""Reading what the page shows, ready to be drawn. Qt-free, called in a thread."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from app.gui.pages.imagination.moments import Moments
from app.gui.pages.imagination.phases import Phase, phases_of
from app.gui.views.scene import PreparedMesh, prepare_mesh
from core.errors import SessionError
from core.files import read_json
from core.geometry import BoolArray, FloatArray
from core.imagination.capacity.result import Capacity
from core.imagination.holding.result import HOLDING_FILE, Holding
from core.imagination.particle_shape import particle_extents_m
from core.imagination.rendering.replay import lowest_point_m, make_replay
from core.imagination.results import Containability
from core.mesh import TriangleMesh
from core.parameters.imagination import ContainabilityParameters, ParticleParameters
from core.session import Session
from core.session.record import StageRecord

_GROUND_GAP_M = 0.0005
_OUTLINE_DIRECTIONS = 180
_NEAR = 0.6
"""How far from the object, as a share of its size, a fallen candy still belongs to the picture."""


@dataclass(frozen=True)
class DropKey:
    """Which files are to be shown: the session's folder and digests, empty for none."""

    folder: Path
    containability: str
    collision: str


@dataclass(frozen=True, eq=False)
class ShownDrop:
    """A drop, ready to be replayed.

    Attributes:
        containability: the result.
        settings: it was imagined with.
        particle: the candy.
        seed: of all its randomness.
        seconds: it took.
        moments: candies and object at any time; what is lost lies where it passed the ground.
        phases: what happened when.
        n_on_top: candies that lie on the object at the end, but not in its bounding box.
        body: the surface that the physics knew.
        candy_radius_m: of a ball of about a candy's volume.
        ground_m: height of the ground, just below everything the object reaches.
        ground_radius_m: wide enough for what fell near the object.
        outline_m: (n, 2) the object from above, its hull.
        indents_m: distances of the pivots from the footprint's centre; empty without pours.
    """

    containability: Containability
    capacity: Capacity | None
    holding: Holding | None
    settings: ContainabilityParameters
    particle: ParticleParameters
    seed: int
    seconds: float
    moments: Moments
    phases: tuple[Phase, ...]
    n_on_top: int
    body: PreparedMesh
    candy_radius_m: float
    ground_m: float
    ground_radius_m: float
    outline_m: FloatArray
    indents_m: tuple[float, ...]


def key_of(session: Session) -> DropKey:
    """Look up the stages' digests; cheap."""
    records = [session.record(stage) for stage in ("containability", "collision")]
    digests = ["" if record is None else record.digest for record in records]
    return DropKey(session.path, *digests)


def load(key: DropKey) -> ShownDrop | None:
    """Read a session's drop; none if nothing was imagined.

    Raises:
        SessionError: a file is damaged, or of another version.
    """
    from core.collision import CollisionModel

    session = Session.open(key.folder)
    record = session.record("containability")
    if record is None or not key.collision:
        return None
    settings, particle = _settings(record, key.folder)
    containability, capacity, holding = _found(session)
    surface = CollisionModel.load(session.folder("collision")).surface
    ground_m = lowest_point_m(surface, containability.recording.T_world_body) - _GROUND_GAP_M
    # As balls the candies are as thick as they are wide: so thick they lie on the ground.
    radius_m = float(np.prod(particle_extents_m(particle)) ** (1 / 3)) / 2
    replay = make_replay(containability.recording, containability.retained, ground_m, 2 * radius_m)
    return ShownDrop(
        containability=containability,
        capacity=capacity,
        holding=holding,
        settings=settings,
        particle=particle,
        seed=int(record.parameters.get("seed", 0)),
        seconds=record.seconds,
        moments=Moments(replay.recording),
        phases=phases_of(containability, settings),
        n_on_top=_n_on_top(containability),
        body=prepare_mesh(surface.vertices_m, surface.faces),
        candy_radius_m=radius_m,
        ground_m=ground_m,
        ground_radius_m=_ground_radius_m(surface, replay.recording.positions_m[-1], replay.retained),
        outline_m=_outline_m(surface),
        indents_m=_indents_m(session),
    )


def _found(session: Session) -> tuple[Containability, Capacity | None, Holding | None]:
    folder = session.folder("containability")
    try:
        is_known = (folder / HOLDING_FILE).is_file()
        return (
            Containability.load(folder),
            Capacity.load(folder) if is_known else None,
            Holding.load(folder) if is_known else None,
        )
    except (KeyError, TypeError, ValueError) as error:
        raise SessionError(f"The drop in {folder} is damaged ({error!r}); imagine it again.") from error


def _settings(record: StageRecord, folder: Path) -> tuple[ContainabilityParameters, ParticleParameters]:
    try:
        return (
            ContainabilityParameters.model_validate(record.parameters["containability"]),
            ParticleParameters.model_validate(record.parameters["particle"]),
        )
    except (KeyError, ValidationError) as error:
        raise SessionError(
            f"What was imagined in {folder} was imagined by another version of Poursight; imagine it again."
        ) from error


def _n_on_top(containability: Containability) -> int:
    """Fallen candies are not recorded any more, or are on their way down."""
    heights_m = containability.recording.positions_m[-1, ~containability.retained, 2]
    with np.errstate(invalid="ignore"):
        return int((heights_m >= containability.aabb_m[1, 2]).sum())


def _ground_radius_m(surface: TriangleMesh, ends_m: FloatArray, retained: BoolArray) -> float:
    """Around the object's middle."""
    middle_m = (surface.aabb_min_m + surface.aabb_max_m)[:2] / 2
    size_m = float(np.linalg.norm(surface.extents_m[:2])) / 2
    fallen_m = np.linalg.norm(ends_m[~retained, :2] - middle_m, axis=1)
    near_m = fallen_m[fallen_m < size_m * (1 + _NEAR)]  # NaN is not
    return max(float(near_m.max(initial=0.0)), 1.2 * size_m)


def _outline_m(surface: TriangleMesh) -> FloatArray:
    """The hull (n, 2) from above: the farthest vertex in each direction."""
    angles = np.linspace(0, 2 * np.pi, _OUTLINE_DIRECTIONS, endpoint=False)
    points_m = surface.vertices_m[:, :2]
    farthest = (points_m @ np.array([np.cos(angles), np.sin(angles)])).argmax(axis=0)
    outline: FloatArray = points_m[farthest]
    return outline


def _indents_m(session: Session) -> tuple[float, ...]:
    """Of the pours that belong to this drop: both are written by the same run."""
    if session.record("pouring") is None or not (session.path / "pouring" / "pours.json").is_file():
        return ()
    return tuple(float(indent) for indent in read_json(session.path / "pouring" / "pours.json")["indent_m"])
