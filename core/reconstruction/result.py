"""What the reconstruction hands on."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import SessionError
from core.files import read_json, write_json
from core.mesh import TriangleMesh
from core.ply import read_ply, write_ply
from core.reconstruction.corrections import Refinement, ViewCorrection
from core.reconstruction.pose_health import PoseHealth, ViewHealth

MESH_FILE = "mesh.ply"
FACTS_FILE = "result.json"


@dataclass(frozen=True)
class Reconstruction:
    """The object's surface and what the report says about it.

    Attributes:
        mesh: closed, outward, in the robot's base frame.
        platform_height_m: the support's height in the base frame under the object.
        truncation_m: the truncation that was used.
        pose_health: the table in every view, with the poses as recorded.
        refinement: how the poses were corrected; none if they were taken as recorded.
    """

    mesh: TriangleMesh
    platform_height_m: float
    truncation_m: float
    pose_health: PoseHealth
    refinement: Refinement | None = None

    def save(self, folder: Path) -> None:
        """Write `mesh.ply` and `result.json` into an existing folder."""
        write_ply(folder / MESH_FILE, self.mesh)
        facts = {
            "platform_height_m": self.platform_height_m,
            "truncation_m": self.truncation_m,
            "pose_health": [asdict(view) for view in self.pose_health.views],
            "refinement": None if self.refinement is None else _refinement_facts(self.refinement),
        }
        write_json(folder / FACTS_FILE, facts)

    @staticmethod
    def load(folder: Path) -> Reconstruction:
        """Read what `save` wrote.

        Raises:
            SessionError: a file is missing or damaged.
        """
        facts = read_json(folder / FACTS_FILE)
        try:
            views = tuple(ViewHealth(**view) for view in facts["pose_health"])
            height_m, truncation_m = float(facts["platform_height_m"]), float(facts["truncation_m"])
            refinement = None if facts["refinement"] is None else _refinement(facts["refinement"])
        except (KeyError, TypeError, ValueError) as error:
            raise SessionError(
                f"{folder / FACTS_FILE} is damaged ({error!r}); run the reconstruction again."
            ) from error
        return Reconstruction(
            read_ply(folder / MESH_FILE), height_m, truncation_m, PoseHealth(views), refinement
        )


def _refinement_facts(refinement: Refinement) -> dict[str, Any]:
    facts = asdict(refinement)
    for view in facts["views"]:
        view["T_base_camera"] = view["T_base_camera"].tolist()
    return facts


def _refinement(facts: dict[str, Any]) -> Refinement:
    views = [
        ViewCorrection(**view | {"T_base_camera": np.array(view["T_base_camera"], dtype=float).reshape(4, 4)})
        for view in facts["views"]
    ]
    return Refinement(**facts | {"views": tuple(views)})
