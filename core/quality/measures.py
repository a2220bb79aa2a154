"""What is measured of a finished scan, in one record that saves and loads itself; light to import."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from core.errors import Remedy, SessionError
from core.files import read_arrays, read_json, write_arrays, write_json
from core.geometry import FloatArray, IntArray
from core.quality.verdict_words import FACTS_FILE
from core.quality.view_quality import ViewQuality

ARRAYS_FILE = "quality.npz"
FEWEST_TABLES = 3
_CAVITY_NUMBERS = ("area_m2", "volume_ml", "depth_m", "width_m")


@dataclass(frozen=True)
class ScanQuality:
    """How good a scan is, and the verdict.

    Attributes:
        views: each view, in the scan's order.
        cavity: what no view saw inside openings.
        n_views: (V,) in how many views each vertex of the reconstructed mesh was seen.
        unseen_share: share of its surface, without what looks down, that no view saw.
        verdict: one of `VERDICTS`.
        reasons: a plain sentence for each reason; the first begins with the verdict.
    """

    views: tuple[ViewQuality, ...]
    cavity: HiddenCavity
    n_views: IntArray
    unseen_share: float
    verdict: str
    reasons: tuple[str, ...]

    @property
    def table_sd_m(self) -> float | None:
        """Standard deviation of the table's height over the views; none when fewer than three see it."""
        return table_sd_m(self.views)

    @property
    def residual_m(self) -> float | None:
        """Median over the views of the rms distance of depth to model."""
        return residual_m(self.views)

    def save(self, folder: Path) -> None:
        """Write `quality.json` and `quality.npz` into an existing folder."""
        facts = {
            "verdict": self.verdict,
            "reasons": list(self.reasons),
            "table_sd_m": self.table_sd_m,
            "residual_m": self.residual_m,
            "unseen_share": self.unseen_share,
            "cavity": {name: getattr(self.cavity, name) for name in _CAVITY_NUMBERS},
            "views": [{**asdict(view), "problems": list(view.problems)} for view in self.views],
        }
        write_json(folder / FACTS_FILE, facts)
        cavity = self.cavity
        write_arrays(
            folder / ARRAYS_FILE, n_views=self.n_views, frontier_m=cavity.frontier_m, region=cavity.region
        )

    @staticmethod
    def load(folder: Path) -> ScanQuality:
        """Read what `save` wrote.

        Raises:
            SessionError: a file is missing or damaged.
        """
        facts, arrays = read_json(folder / FACTS_FILE), read_arrays(folder / ARRAYS_FILE)
        try:
            fields = [{k: v for k, v in view.items() if k != "problems"} for view in facts["views"]]
            return ScanQuality(
                tuple(ViewQuality(**view) for view in fields),
                HiddenCavity(arrays["frontier_m"], arrays["region"], **facts["cavity"]),
                arrays["n_views"],
                float(facts["unseen_share"]),
                str(facts["verdict"]),
                tuple(map(str, facts["reasons"])),
            )
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise SessionError(f"{folder / FACTS_FILE} is damaged ({error!r}).", Remedy.RUN_AGAIN) from error


def table_sd_m(views: tuple[ViewQuality, ...]) -> float | None:
    """Standard deviation of the table's height over the views; none when fewer than three see it."""
    heights = [view.table_height_m for view in views if view.table_height_m is not None]
    return float(np.std(heights, ddof=1)) if len(heights) >= FEWEST_TABLES else None


def residual_m(views: tuple[ViewQuality, ...]) -> float | None:
    """Median over the views of the rms distance of depth to model; none if none shows the object."""
    residuals = [view.residual_rms_m for view in views if view.residual_rms_m is not None]
    return float(np.median(residuals)) if residuals else None


@dataclass(frozen=True)
class HiddenCavity:
    """What no view saw inside the openings; all empty and zero when everything was seen.

    Attributes:
        frontier_m: (N, 3) voxel centres in the base frame, where known free space ends at the unseen.
        region: (M, 3) voxels of the volume, the frontier and the unseen that lies enclosed behind it. It
            includes the cores of walls and floors, which no view can see.
        area_m2: of the frontier.
        volume_ml: of the region, so the most that may be hidden.
        depth_m: from the rim down to the middle of the frontier, in the opening with the most of it.
        width_m: of that opening just below its rim, as the diameter of a circle of its area.
    """

    frontier_m: FloatArray
    region: IntArray
    area_m2: float = 0.0
    volume_ml: float = 0.0
    depth_m: float = 0.0
    width_m: float = 0.0
