"""What the modes of the 3D view show: their colours and captions, and why one is not available."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QCoreApplication

from app.gui.pages.reconstruction.loading import MM, ShownModel
from app.gui.views.scene import ColorScale
from core.geometry import FloatArray

if TYPE_CHECKING:  # it brings the fusion along
    from core.quality.measures import ScanQuality

translate = QCoreApplication.translate

PHOTO = "photo"
"""The mode that shows the surface as the camera saw it."""
LEAST_SCALE_MM = 0.5
"""Of a difference; less is noise and should not look like much."""
_SHOWN_SHARE = 98.0
_CM2 = 1e4


def mode_tips(model: ShownModel | None, has_difference: bool) -> dict[str, tuple[bool, str]]:
    """Return for the modes that need more than a surface whether they are available, and what they are."""
    has_views = model is not None and model.quality is not None
    coverage = translate("ModelModes", "In how many views each place was seen, and what no view saw")
    if model is not None and model.reconstruction is None:
        coverage = translate("ModelModes", "An imported mesh has no views")
    elif model is not None and not has_views:
        coverage = translate("ModelModes", "The scan was not checked with this model yet; reconstruct")
    has_parts = model is not None and model.collision is not None
    collision = translate("ModelModes", "The bodies that the physics collides with, over the surface")
    if model is not None and not has_parts:
        collision = translate("ModelModes", "The collision model is not built yet; reconstruct")
    difference = translate("ModelModes", "Change a parameter and reconstruct to compare the results here")
    if has_difference:
        difference = translate("ModelModes", "How far the surface moved since the last result")
    photo = translate("ModelModes", "The surface in the colours of the scan's images")
    if model is not None and model.reconstruction is None:
        photo = translate("ModelModes", "An imported mesh has no images")
    elif model is not None and model.body.rgb is None:
        photo = translate("ModelModes", "The model was made without colours; reconstruct")
    return {
        PHOTO: (model is not None and model.body.rgb is not None, photo),
        "coverage": (has_views, coverage),
        "collision": (has_parts, collision),
        "difference": (has_difference, difference),
    }


def mode_colors(
    model: ShownModel, mode: str, difference_m: FloatArray | None
) -> tuple[FloatArray, ColorScale] | None:
    """Return a number (V,) for each vertex, NaN where there is none, and its colours; none if plain."""
    if mode == "height":
        above_mm = (model.mesh.vertices_m[:, 2] - ground_m(model)) * MM
        top_mm = float(model.mesh.aabb_max_m[2] - ground_m(model)) * MM
        return above_mm, ColorScale(translate("ModelModes", "Height"), "mm", 0.0, top_mm)
    if mode == "coverage" and model.quality is not None:
        n_views = model.quality.n_views.astype(float)
        most = -4 * (-len(model.quality.views) // 4)  # so that the scale's five numbers are whole
        scale = ColorScale(translate("ModelModes", "Seen in views"), "", 0.0, float(most))
        return np.where(n_views > 0, n_views, np.nan), scale
    if mode == "difference" and difference_m is not None:
        return difference_m * MM, difference_scale(difference_m, translate("ModelModes", "Moved"))
    return None


def difference_scale(difference_m: FloatArray, label: str) -> ColorScale:
    """Return a scale, the same both ways, for distances (V,) in metres that are shown in mm."""
    most_mm = max(float(np.percentile(np.abs(difference_m), _SHOWN_SHARE)) * MM, LEAST_SCALE_MM)
    decade = 10.0 ** np.floor(np.log10(most_mm))
    limit = next(step * decade for step in (1, 2, 5, 10) if step * decade >= most_mm * (1 - 1e-9))
    return ColorScale(label, "mm", -float(limit), float(limit))


def difference_numbers_mm(difference_m: FloatArray) -> tuple[float, float]:
    """Mean of the distances' magnitudes (V,), and what 95 % of them stay below."""
    magnitudes_mm = np.abs(difference_m) * MM
    return float(magnitudes_mm.mean()), float(np.percentile(magnitudes_mm, 95))


def caption(model: ShownModel | None, mode: str, difference_m: FloatArray | None, unseen_color: str) -> str:
    """Say what a mode shows; `unseen_color` (`#rrggbb`) is that of places no view saw."""
    if model is None:
        return ""
    if mode == "height":
        if model.reconstruction is None:
            return translate("ModelModes", "Height above the lowest point.")
        return translate("ModelModes", "Height above the platform.")
    if mode == "coverage" and model.quality is not None:
        return _coverage_caption(model.quality, f'<span style="color:{unseen_color}">■</span>')
    if mode == "collision":
        return _collision_caption(model)
    if mode == "difference" and difference_m is not None:
        mean_mm, most_mm = difference_numbers_mm(difference_m)
        return translate(
            "ModelModes",
            "How far the surface lies outside (+) or inside (-) the last result: "
            "{mean:.2f} mm on average, 95 % of it within {most:.2f} mm.",
        ).format(mean=mean_mm, most=most_mm)
    return translate(
        "ModelModes",
        "Drag to rotate, Shift and drag to move, wheel to zoom, double-click to centre. Squares: 1 cm.",
    )


def _coverage_caption(quality: ScanQuality, mark: str) -> str:
    said = translate(
        "ModelModes",
        "In how many of {n} views each place was seen. {mark} In none: {share:.1f} % of the surface, "
        "undersides excepted.",
    ).format(n=len(quality.views), mark=mark, share=100 * quality.unseen_share)
    if quality.cavity.area_m2 > 0:
        said += " " + translate(
            "ModelModes",
            "Points: where the views ended inside an opening, {area:.1f} cm²; it counts as solid.",
        ).format(area=quality.cavity.area_m2 * _CM2)
    return said


def _collision_caption(model: ShownModel) -> str:
    collision = model.collision
    if collision is None:
        return ""
    if collision.method == "exact":
        said = translate("ModelModes", "The physics collides with the surface itself: {n:,} faces, as wires.")
        return said.format(n=collision.n_faces)
    names = {"vhacd": "V-HACD", "coacd": "CoACD", "given": translate("ModelModes", "as in the file")}
    return translate("ModelModes", "{n} convex parts ({method}), each in its own tint.").format(
        n=collision.n_parts, method=names.get(collision.method, collision.method)
    )


def ground_m(model: ShownModel) -> float:
    """Return what heights are counted from: the platform, or the lowest point of an imported mesh."""
    if model.reconstruction is None:
        return float(model.mesh.aabb_min_m[2])
    return model.reconstruction.platform_height_m
