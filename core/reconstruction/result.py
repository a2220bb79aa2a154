"""What the reconstruction hands on: the surface, the poses' health, and how the poses were corrected."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import Remedy, SessionError
from core.files import read_json, write_json
from core.geometry import FloatArray
from core.mesh import TriangleMesh
from core.mesh_file import read_ply, write_ply
from core.reconstruction.pose_health import PoseHealth, ViewHealth
from core.scan.model import Scan
from core.unseen_readings import UnseenReadings

MESH_FILE = "mesh.ply"
FACTS_FILE = "result.json"
SURFACE_PER_VIEW_ERROR = 3.0
"""Thin walls and rims come out thicker and lower than many views' mean would be: measured on 20 shapes."""


@dataclass(frozen=True)
class Reconstruction:
    """The object's surface and what the report says about it.

    Attributes:
        mesh: closed, outward, in the robot's base frame.
        platform_height_m: the support's height in the base frame under the object.
        truncation_m: the truncation that was used.
        pose_health: the table in every view, with the poses as recorded.
        refinement: how the poses were corrected; none if they were taken as recorded.
        unseen: other surfaces that the views allow, where they did not see into an opening; else none.
    """

    mesh: TriangleMesh
    platform_height_m: float
    truncation_m: float
    pose_health: PoseHealth
    refinement: Refinement | None = None
    unseen: UnseenReadings | None = None

    @property
    def surface_error_m(self) -> float:
        """How far the surface may lie from the true one; zero if the views' error is unknown."""
        known = None if self.refinement is None else self.refinement.view_error_m
        return SURFACE_PER_VIEW_ERROR * (known or 0.0)

    def save(self, folder: Path) -> None:
        """Write `mesh.ply` and `result.json` into an existing folder, and what the unseen may be."""
        write_ply(folder / MESH_FILE, self.mesh)
        if self.unseen is not None:
            self.unseen.save(folder)
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
            raise SessionError(f"{folder / FACTS_FILE} is damaged ({error!r}).", Remedy.RUN_AGAIN) from error
        return Reconstruction(
            read_ply(folder / MESH_FILE),
            height_m,
            truncation_m,
            PoseHealth(views),
            refinement,
            UnseenReadings.load(folder),
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


@dataclass(frozen=True)
class ViewCorrection:
    """What one view's pose was changed by, and how well it fits the others.

    Attributes:
        name: of the view.
        shift_m: how far the camera was moved.
        turn_rad: by what angle it was rotated.
        residual_before_m: distance (rms) of its points from the surfaces of the other views, with the
            recorded poses; none if it meets no other view.
        residual_after_m: the same with the corrected poses.
        T_base_camera: (4, 4), the corrected pose.
    """

    name: str
    shift_m: float
    turn_rad: float
    residual_before_m: float | None
    residual_after_m: float | None
    T_base_camera: FloatArray


@dataclass(frozen=True)
class Refinement:
    """The corrections of all views, in the order of the scan, and what they brought.

    Attributes:
        views: one correction each.
        residual_before_m: distance (rms) between the views' surfaces, with the recorded poses; none if no two
            views show the same.
        residual_after_m: the same with the corrected poses.
        table_sd_before_m: standard deviation of the table's height over the views; none without a table.
        table_sd_after_m: the same with the corrected poses.
        view_error_m: how far (standard deviation) the surface that one view shows errs after the correction,
            by the nearest matches; noise of the depth included.
    """

    views: tuple[ViewCorrection, ...]
    residual_before_m: float | None
    residual_after_m: float | None
    table_sd_before_m: float | None
    table_sd_after_m: float | None
    view_error_m: float | None

    def applied_to(self, scan: Scan) -> Scan:
        """Return the scan with the corrected poses."""
        frames = zip(scan.frames, self.views, strict=True)
        return replace(
            scan, frames=tuple(replace(frame, T_base_camera=view.T_base_camera) for frame, view in frames)
        )
