"""Whether the motions that a session holds belong to its pours and to a cell; light enough for the window."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from core.motion.pour.choosing import PourMotions
from core.session import Session

if TYPE_CHECKING:
    from hardware.cell.settings import CellSettings

MOTION_INPUTS = ("containability", "pouring")


def described_cell(settings: CellSettings) -> dict[str, Any]:
    """Return what of a cell decides whether a pour can be made, as the record of the motions keeps it."""
    table: dict[str, Any] = json.loads(
        settings.model_dump_json(include={"robot", "gripper", "camera", "place", "motion", "obstacles"})
    )
    return table


def current_motions(session: Session, settings: CellSettings) -> PourMotions | None:
    """Return which of a session's pours a cell's arm can make; none if nobody asked since they changed.

    Raises:
        SessionError: they cannot be read.
    """
    digests: dict[str, str] = {}
    for stage in MOTION_INPUTS:
        record = session.record(stage)
        if record is None:
            return None
        digests[stage] = record.digest
    if not session.is_fresh("motion", digests, described_cell(settings)):
        return None
    return PourMotions.load(session.folder("motion"))
