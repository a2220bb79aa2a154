"""The rules behind the verdict, and their sentences.

The limits come from simulated scans with growing pose errors (docs/decisions/0007-scan-quality.md) and lie
where the reconstruction still holds, so that the warning comes before the failure.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from core.quality.hidden_cavity import HiddenCavity
from core.quality.measures import residual_m, table_sd_m
from core.quality.view_quality import ViewQuality

GOOD, USABLE, AGAIN = "good", "usable", "scan again"
VERDICTS = (GOOD, USABLE, AGAIN)

TABLE_SD_USABLE_M, TABLE_SD_AGAIN_M = 0.0025, 0.006
"""With refined poses the surface errs by 1 mm from 3.5 mm on, and walls get lost from 8.5 mm on."""
RESIDUAL_USABLE_M, RESIDUAL_AGAIN_M = 0.001, 0.0014
"""0.6 mm with refined poses; capacity begins to be 10 % off at 1.2 mm; above 1.4 mm most are."""
UNSEEN_USABLE = 0.10
"""More makes a scan usable, not worse: a belly below a narrow neck shows itself to no view at all."""
HIDDEN_AREA_USABLE_M2 = 2e-4
SHIFTED_TABLE_M = 0.003
MOST_TOLD = 3
"""Views whose problems are told one by one."""
FEWEST_VIEWS = 12
CALIBRATE = "calibrate the camera's mounting"


@dataclass(frozen=True)
class Reason:
    """Why the scan is no better than `verdict`."""

    verdict: str
    sentence: str


def judge(
    views: tuple[ViewQuality, ...], cavity: HiddenCavity, unseen_share: float
) -> tuple[str, tuple[str, ...]]:
    """Return the verdict and its reasons, the worst first."""
    found = [*_of_views(views), *_of_poses(views), *_of_coverage(cavity, unseen_share)]
    if not found:
        return GOOD, ("good: the views agree, and they saw the object and the inside of its openings.",)
    found.sort(key=lambda reason: VERDICTS.index(reason.verdict), reverse=True)
    return found[0].verdict, tuple(f"{reason.verdict}: {reason.sentence}" for reason in found)


def _of_views(views: tuple[ViewQuality, ...]) -> Iterator[Reason]:
    n_useful = sum(not view.is_useless for view in views)
    if n_useful < FEWEST_VIEWS:
        yield Reason(
            AGAIN,
            f"only {n_useful} of {len(views)} views show anything, {FEWEST_VIEWS} are needed; "
            "take the others again.",
        )
    problems = [problem for view in views for problem in view.problems]
    yield from (Reason(USABLE, problem) for problem in problems[:MOST_TOLD])
    if len(problems) > MOST_TOLD:
        yield Reason(
            USABLE, f"{len(problems) - MOST_TOLD} more problems of single views are in quality.json."
        )


def _of_poses(views: tuple[ViewQuality, ...]) -> Iterator[Reason]:
    sd_m, rms_m = table_sd_m(views), residual_m(views)
    if sd_m is not None and sd_m > TABLE_SD_USABLE_M:
        yield Reason(
            AGAIN if sd_m > TABLE_SD_AGAIN_M else USABLE,
            f"the views disagree about the table by {_mm(sd_m)} (the model is off its place above "
            f"{_mm(TABLE_SD_USABLE_M)}, walls get lost above {_mm(TABLE_SD_AGAIN_M)}): {CALIBRATE}.",
        )
    offsets_m = [view.table_offset_m for view in views if view.table_offset_m is not None]
    shift_m = float(np.median(offsets_m)) if offsets_m else 0.0
    if abs(shift_m) > SHIFTED_TABLE_M:
        side = "above" if shift_m > 0 else "below"
        yield Reason(USABLE, f"the views see the table {_mm(abs(shift_m))} {side} its place: {CALIBRATE}.")
    if rms_m is not None and rms_m > RESIDUAL_USABLE_M:
        yield Reason(
            AGAIN if rms_m > RESIDUAL_AGAIN_M else USABLE,
            f"the depth images lie {_mm(rms_m)} off the model (its walls are wrong above "
            f"{_mm(RESIDUAL_AGAIN_M)}): {CALIBRATE}, see that the object does not move, and reconstruct "
            "with the default settings.",
        )


def _of_coverage(cavity: HiddenCavity, unseen_share: float) -> Iterator[Reason]:
    if cavity.area_m2 > HIDDEN_AREA_USABLE_M2:
        yield Reason(
            USABLE,
            f"the inside of an opening {cavity.width_m * 1000:.0f} mm wide was not seen below "
            f"{cavity.depth_m * 1000:.0f} mm, where it counts as solid; look again with --adaptive.",
        )
    if unseen_share > UNSEEN_USABLE:
        yield Reason(
            USABLE,
            f"no view saw {unseen_share:.0%} of the surface; what lies behind it counts as solid.",
        )


def _mm(length_m: float) -> str:
    return f"{length_m * 1000:.1f} mm"
