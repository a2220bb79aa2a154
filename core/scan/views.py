"""Which views of a scan say something."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from core.errors import InputError
from core.progress import Reporter
from core.scan.model import RgbdFrame

FEWEST_VIEWS = 3
SAME_POSE = 1e-9


def leave_out_useless(frames: Sequence[RgbdFrame], folder: Path, reporter: Reporter) -> list[RgbdFrame]:
    """Return the frames without empty and repeated ones; what is left out is told through `reporter`.

    Raises:
        InputError: leaving out leaves fewer than three views.
    """
    kept = _without_repeated(_without_empty(frames, folder, reporter), folder, reporter)
    if len(kept) < min(FEWEST_VIEWS, len(frames)) or not kept:
        raise InputError(
            f"Only {len(kept)} of the {len(frames)} views in {folder} can be used, the others are empty or "
            f"repeated; at least {FEWEST_VIEWS} are needed, so scan again."
        )
    return kept


def _without_empty(frames: Sequence[RgbdFrame], folder: Path, reporter: Reporter) -> list[RgbdFrame]:
    kept = []
    for frame in frames:
        if frame.depth_m.any():
            kept.append(frame)
        else:
            reporter.warn(
                f"The depth image {folder / frame.name}.depth.png is empty (all zero); this view is left out."
            )
    return kept


def _without_repeated(frames: Sequence[RgbdFrame], folder: Path, reporter: Reporter) -> list[RgbdFrame]:
    kept: list[RgbdFrame] = []
    for frame in frames:
        twins = [
            other for other in kept if np.abs(other.T_base_camera - frame.T_base_camera).max() < SAME_POSE
        ]
        copies = [other for other in twins if np.array_equal(other.depth_m, frame.depth_m)]
        if copies:
            reporter.warn(
                f"The view {folder / frame.name} repeats {copies[0].name} (same pose, same depth image); "
                "it is left out."
            )
            continue
        if twins:
            reporter.warn(
                f"The views {folder / frame.name} and {twins[0].name} have the same pose but different "
                "images; check that their pose files belong to them."
            )
        kept.append(frame)
    return kept
