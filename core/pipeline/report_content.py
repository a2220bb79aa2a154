"""Gathering what a report shows from the session's files."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from core.files import read_content
from core.imagination.imagination import Imagination
from core.imagination.rendering.evidence import Evidence
from core.mesh import TriangleMesh
from core.motion.pour.feasibility import PourMotions
from core.parameters import Parameters
from core.quality.measures import ScanQuality
from core.reconstruction.result import Reconstruction
from core.report import Media, ReportContent
from core.session import Session
from core.session.operator_choice import read_operator_choice
from core.session.pour_runs import pour_runs
from core.session.record import StageRecord
from core.stages import STAGE_NAMES

if TYPE_CHECKING:
    from PIL.Image import Image

_THUMBNAIL_PX, _MODEL_PX = (240, 180), (640, 480)
_CAPTIONS = {
    "drop_1_start.png": "Start",
    "drop_2_falling.png": "Falling",
    "drop_3_settled.png": "Settled",
    "drop_4_rotated.png": "Rotated",
    "drop_5_pushed.png": "Pushed",
    "drop_6_end.png": "End",
    "pours.png": "The pours at their end",
    "drop.mp4": "The drop and the perturbations",
    "pour.mp4": "The chosen pour",
}


def gather(
    session: Session,
    preset: tuple[str, Parameters],
    parameters: Parameters,
    surface: TriangleMesh,
    reconstruction: Reconstruction | None,
    quality: ScanQuality | None,
    imagination: Imagination,
    evidence: Evidence,
    motions: PourMotions | None,
    warnings: list[str],
) -> ReportContent:
    """Put together everything the report shows."""
    named = {_CAPTIONS[name]: evidence.files[name] for name in _CAPTIONS if name in evidence.files}
    films = {_CAPTIONS[name] for name in evidence.files if name.endswith(".mp4")}
    records = {stage: session.record(stage) for stage in STAGE_NAMES}
    made = {stage: record for stage, record in records.items() if record is not None}
    return ReportContent(
        name=session.name,
        created=session.created,
        preset_name=preset[0],
        preset=preset[1],
        parameters=parameters,
        containability=imagination.containability,
        surface=surface,
        reconstruction=reconstruction,
        quality=quality,
        pours=imagination.grid,
        capacity=imagination.capacity,
        retention=imagination.retention,
        amount=imagination.amount,
        choice=imagination.choice,
        risk=imagination.risk if motions is None or motions.risk is None else motions.risk,
        paper_choice=imagination.paper_choice,
        model_pictures=_model_pictures(session, surface),
        scan_pictures=_thumbnails(session.path / "scan" / "rgbd"),
        pictures={caption: content for caption, content in named.items() if caption not in films},
        films={caption: content for caption, content in named.items() if caption in films},
        seconds={stage: record.seconds for stage, record in made.items()},
        known_s=_known_s(made),
        versions=made["containability"].versions,
        warnings=tuple(warnings),
        motions=motions,
        runs=tuple(pour_runs(session.path)),
        operator=read_operator_choice(session.path, made["pouring"].digest),
    )


def _known_s(made: Mapping[str, StageRecord]) -> dict[str, float]:
    """Seconds from the scan's last view to the end of each stage, by the records' clocks."""
    if "scan" not in made:
        return {}
    ended = {stage: datetime.fromisoformat(record.created) for stage, record in made.items()}
    known_s = {stage: (time - ended["scan"]).total_seconds() for stage, time in ended.items()}
    return {stage: seconds for stage, seconds in known_s.items() if seconds >= 0}


def _model_pictures(session: Session, surface: TriangleMesh) -> dict[str, Media]:
    """The surface from both sides, if the session has its colours."""
    from core.mesh_picture import shaded_picture  # both bring Pillow along
    from core.reconstruction.colors import ModelColors

    if session.record("colors") is None:
        return {}
    rgb = ModelColors.load(session.folder("colors")).rgb
    if len(rgb) != len(surface.vertices_m):
        return {}
    seen = {"The model": surface, "From behind": _turned(surface)}
    return {caption: _jpeg(shaded_picture(mesh, _MODEL_PX, rgb=rgb)) for caption, mesh in seen.items()}


def _turned(mesh: TriangleMesh) -> TriangleMesh:
    """Half around z."""
    return TriangleMesh(mesh.vertices_m * [-1.0, -1.0, 1.0], mesh.faces)


def _jpeg(picture: Image) -> bytes:
    buffer = BytesIO()
    picture.save(buffer, "JPEG", quality=90)
    return buffer.getvalue()


def _thumbnails(folder: Path) -> dict[str, Media]:
    from PIL import Image

    pictures: dict[str, Media] = {}
    for path in sorted(folder.glob("frame-*.color.png")):
        buffer = BytesIO()
        name = path.name.split(".")[0]
        try:
            with Image.open(BytesIO(read_content(path))) as image:
                image.thumbnail(_THUMBNAIL_PX)
                image.convert("RGB").save(buffer, "JPEG", quality=80)
        except Exception:  # Pillow raises another kind for each way in which a picture can be damaged
            pictures[name] = path  # the page says that it cannot be shown
        else:
            pictures[name] = buffer.getvalue()
    return pictures
