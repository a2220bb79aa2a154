"""What the page shows of a session, read in the background and ready to be drawn. Knows no Qt."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from app.gui.pages.photographed import in_colors
from app.gui.views.scene import ColorScale, PreparedMesh, prepare_mesh
from core.geometry import FloatArray
from core.mesh import TriangleMesh
from core.mesh_file import read_ply
from core.mesh_topology import join, topology
from core.pipeline.session_view import SessionView
from core.session import Session

if TYPE_CHECKING:  # they bring the fusion along
    from core.collision import CollisionModel
    from core.quality.measures import ScanQuality
    from core.reconstruction.result import Reconstruction
    from core.scan import CropBox

MM = 1000.0
_GOLDEN = 0.618


@dataclass(frozen=True)
class ModelKey:
    """Which files are to be shown: the session's folder and the digests of its stages, empty for none."""

    folder: Path
    scan: str
    surface: str
    quality: str
    collision: str
    colors: str


@dataclass(frozen=True, eq=False)
class Collision:
    """What the physics collides with.

    Attributes:
        method: as in the parameters, or `given`.
        n_parts: how many bodies.
        n_faces: of all together.
        mesh: wires for one exact surface, tinted parts otherwise.
        centers_m: (F, 3) of its faces.
    """

    method: str
    n_parts: int
    n_faces: int
    mesh: PreparedMesh
    centers_m: FloatArray


@dataclass(frozen=True, eq=False)
class ShownModel:
    """A surface and all that is known of it.

    Attributes:
        digest: of its stage's files.
        mesh: the surface.
        body: the same, ready to be drawn; in its photographed colours where they are known.
        centers_m: (F, 3) of its faces.
        is_closed: whether it encloses a volume.
        reconstruction: none for an imported mesh.
        quality: of the scan; none if it was not checked with this surface.
        collision: none if it was not built from this surface.
        health: how well the poses agree, in sentences; empty for an imported mesh.
    """

    digest: str
    mesh: TriangleMesh
    body: PreparedMesh
    centers_m: FloatArray
    is_closed: bool
    reconstruction: Reconstruction | None
    quality: ScanQuality | None
    collision: Collision | None
    health: str


@dataclass(frozen=True, eq=False)
class Loaded:
    """What a session holds for the page.

    Attributes:
        key: what it was read for.
        own_box: the crop box that holds while the parameters give none; none for an imported mesh.
        model: none before there is one.
    """

    key: ModelKey
    own_box: CropBox | None
    model: ShownModel | None


def key_of(view: SessionView) -> ModelKey:
    """Look up the stages' digests."""
    records = {
        stage: view.finished.get(stage)
        for stage in ("scan", "mesh", "reconstruction", "quality", "collision", "colors")
    }
    digests = {stage: "" if record is None else record.digest for stage, record in records.items()}
    surface = digests["mesh"] or digests["reconstruction"]
    parts = (digests[stage] for stage in ("quality", "collision", "colors"))
    return ModelKey(view.session.path, digests["scan"], surface, *parts)


def load_model(key: ModelKey) -> Loaded:
    """Read a session's model.

    Raises:
        SessionError: a file is damaged.
        InputError: the scan's facts are damaged.
    """
    session = Session.open(key.folder)
    is_mesh = session.record("mesh") is not None
    own_box = None if is_mesh or not key.scan else _own_box(session)
    return Loaded(key, own_box, _model(session, key, is_mesh) if key.surface else None)


def _own_box(session: Session) -> CropBox:
    from core.scan.authors_layout import FACTS_FILE, read_facts
    from core.scan.model import RELEASED_BOX

    return read_facts(session.folder("scan") / FACTS_FILE)[1] or RELEASED_BOX


def _model(session: Session, key: ModelKey, is_mesh: bool) -> ShownModel:
    reconstruction = None if is_mesh else _reconstruction(session)
    source = "mesh" if is_mesh else "reconstruction"
    mesh = read_ply(session.folder("mesh") / "mesh.ply") if reconstruction is None else reconstruction.mesh
    return ShownModel(
        digest=key.surface,
        mesh=mesh,
        body=in_colors(prepare_mesh(mesh.vertices_m, mesh.faces, is_shaded=True), mesh, SessionView(session)),
        centers_m=_centers_m(mesh),
        is_closed=topology(mesh).is_closed,
        reconstruction=reconstruction,
        quality=_quality(session) if _is_of(session, "quality", "reconstruction", key.surface) else None,
        collision=_collision(session) if _is_of(session, "collision", source, key.surface) else None,
        health="" if reconstruction is None else _health(reconstruction),
    )


def _is_of(session: Session, stage: str, source: str, digest: str) -> bool:
    """Whether a stage was made from the very surface that is shown."""
    record = session.record(stage)
    return record is not None and record.inputs.get(source) == digest


def _reconstruction(session: Session) -> Reconstruction:
    from core.reconstruction.result import Reconstruction

    return Reconstruction.load(session.folder("reconstruction"))


def _quality(session: Session) -> ScanQuality:
    from core.quality.measures import ScanQuality

    return ScanQuality.load(session.folder("quality"))


def _collision(session: Session) -> Collision:
    from core.collision import CollisionModel

    model = CollisionModel.load(session.folder("collision"))
    whole = join(model.parts)
    mesh = (
        _tinted(model) if model.is_convex else prepare_mesh(whole.vertices_m, whole.faces, is_wireframe=True)
    )
    return Collision(model.method, len(model.parts), len(whole.faces), mesh, _centers_m(whole))


def _tinted(model: CollisionModel) -> PreparedMesh:
    """The parts with tints that differ from their neighbours'."""
    whole = join(model.parts)
    tints = [(_GOLDEN * part) % 1 for part in range(len(model.parts))]
    values = np.repeat(tints, [len(part.vertices_m) for part in model.parts])
    return prepare_mesh(whole.vertices_m, whole.faces, values=values, scale=ColorScale("", "", 0, 1))


def _health(reconstruction: Reconstruction) -> str:
    from core.report.tables import health_sentence, refinement_sentence

    return f"{health_sentence(reconstruction)} {refinement_sentence(reconstruction)}".strip()


def _centers_m(mesh: TriangleMesh) -> FloatArray:
    centers: FloatArray = mesh.vertices_m[mesh.faces].mean(axis=1)
    return centers
