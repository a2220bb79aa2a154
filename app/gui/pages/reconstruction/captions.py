"""What the page says under the 3D view, and why a mode cannot be chosen."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QObject

from app.gui.pages.reconstruction.loading import MM, ShownModel
from core.geometry import FloatArray

_CM2 = 1e4


class Captions(QObject):
    """Sentences on a model."""

    def of(
        self, model: ShownModel | None, mode: str, difference_m: FloatArray | None, unseen_color: str
    ) -> str:
        """Say what a mode shows; `unseen_color` (`#rrggbb`) is that of places no view saw."""
        if model is None:
            return ""
        if mode == "height":
            ground = self.tr("platform") if model.reconstruction is not None else self.tr("lowest point")
            return self.tr("Height above the {ground}.").format(ground=ground)
        if mode == "coverage":
            return self._coverage(model, f'<span style="color:{unseen_color}">■</span>')
        if mode == "collision":
            return self._collision(model)
        if mode == "difference" and difference_m is not None:
            return self._difference(difference_m)
        return self.tr("Drag to turn, Shift and drag to move, wheel to zoom, double click to centre.")

    def coverage_tip(self, model: ShownModel | None) -> str:
        """What the mode is, or why it is not there."""
        if model is not None and model.reconstruction is None:
            return self.tr("An imported mesh has no views")
        if model is not None and model.quality is None:
            return self.tr("The scan was not judged with this model yet; reconstruct")
        return self.tr("In how many views each place was seen, and what no view saw")

    def collision_tip(self, model: ShownModel | None) -> str:
        """What the mode is, or why it is not there."""
        if model is not None and model.collision is None:
            return self.tr("The collision model of this surface is not built yet; reconstruct")
        return self.tr("The bodies that the physics collides with, over the surface")

    def difference_tip(self, is_known: bool) -> str:
        """What the mode is, or why it is not there."""
        if is_known:
            return self.tr("How far the surface moved since the last result")
        return self.tr("Change a parameter and reconstruct: then the two results are compared here")

    def _coverage(self, model: ShownModel, mark: str) -> str:
        quality = model.quality
        if quality is None:
            return ""
        said = self.tr(
            "In how many of {n} views each place was seen. {mark} In none: {share:.1f} % of the surface, "
            "without the underside."
        ).format(n=len(quality.views), mark=mark, share=100 * quality.unseen_share)
        if quality.cavity.area_m2 > 0:
            said += " " + self.tr(
                "Points: where the views ended inside an opening, {area:.1f} cm²; it counts as solid."
            ).format(area=quality.cavity.area_m2 * _CM2)
        return said

    def _collision(self, model: ShownModel) -> str:
        collision = model.collision
        if collision is None:
            return ""
        if collision.method == "exact":
            return self.tr("The physics collides with the surface itself: the wires, {n:,} faces.").format(
                n=collision.n_faces
            )
        names = {"vhacd": "V-HACD", "coacd": "CoACD", "given": self.tr("as in the file")}
        return self.tr("{n} convex parts ({method}), each with a tint of its own.").format(
            n=collision.n_parts, method=names.get(collision.method, collision.method)
        )

    def _difference(self, difference_m: FloatArray) -> str:
        mean_mm, most_mm = difference_numbers_mm(difference_m)
        return self.tr(
            "How far the surface lies outside (+) or inside (-) of the last result: "
            "{mean:.2f} mm on average, 95 % of it within {most:.2f} mm."
        ).format(mean=mean_mm, most=most_mm)


def difference_numbers_mm(difference_m: FloatArray) -> tuple[float, float]:
    """Mean of the distances' magnitudes (V,), and what 95 % of them stay below."""
    magnitudes_mm = np.abs(difference_m) * MM
    return float(magnitudes_mm.mean()), float(np.percentile(magnitudes_mm, 95))
