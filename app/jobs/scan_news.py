"""What the host that scans tells on its way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray

State = Literal["pending", "taken", "poor", "failed"]


@dataclass(frozen=True, eq=False)
class ViewNews:
    """A view of the scan and what became of it so far.

    Attributes:
        name: the frame's, such as `frame-000003`.
        state: pending, taken, poor (taken, but deserves another try) or failed.
        problems: a plain sentence each.
        T_base_camera: (4, 4) where the camera stands for it; none as long as a recorded scan has not told.
    """

    name: str
    state: State
    problems: tuple[str, ...]
    T_base_camera: FloatArray | None


@dataclass(frozen=True, eq=False)
class ViewsPlanned:
    """All views of the scan, told when it begins and whenever further ones are added."""

    views: tuple[ViewNews, ...]


@dataclass(frozen=True, eq=False)
class ViewDone:
    """A view was taken, or could not be.

    Attributes:
        view: what became of it.
        color: (H, W, 3) uint8, RGB; none if it failed.
        depth_m: (H, W) float32, 0 where nothing was measured; none if it failed.
    """

    view: ViewNews
    color: npt.NDArray[np.uint8] | None
    depth_m: npt.NDArray[np.float32] | None


@dataclass(frozen=True, eq=False)
class MeshGrown:
    """Everything seen so far, fused coarsely.

    Attributes:
        vertices_m: (N, 3) float32, in the base frame.
        faces: (F, 3) int32.
    """

    vertices_m: npt.NDArray[np.float32]
    faces: npt.NDArray[np.int32]


@dataclass(frozen=True)
class Proposal:
    """Views that would show more of the inside; the result of `ScanWork.propose`.

    Attributes:
        n_views: how many; zero if none would show more.
        revealed_share: of what is hidden inside openings, 0 to 1, as far as can be told beforehand.
    """

    n_views: int
    revealed_share: float
