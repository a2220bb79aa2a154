"""Events of a scan in a host process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from core.geometry import FloatArray

State = Literal["pending", "taken", "poor", "failed"]


@dataclass(frozen=True, eq=False)
class ViewProgress:
    """A view of the scan and what became of it so far.

    Attributes:
        name: the frame's, such as `frame-000003`.
        state: pending, taken, poor (taken, but deserves another try) or failed.
        problems: a plain sentence each.
        T_base_camera: (4, 4) where the camera is for it; none as long as a recorded scan has not been played.
    """

    name: str
    state: State
    problems: tuple[str, ...]
    T_base_camera: FloatArray | None


@dataclass(frozen=True, eq=False)
class ViewsPlanned:
    """All views of the scan, when it begins and whenever further ones are added."""

    views: tuple[ViewProgress, ...]


@dataclass(frozen=True)
class ScanQuestion:
    """The scan waits until somebody resumes or cancels it; the sentence says what would happen."""

    sentence: str


@dataclass(frozen=True, eq=False)
class ViewDone:
    """A view was taken, or could not be.

    Attributes:
        view: what became of it.
        color: (H, W, 3) uint8, RGB; none if it failed.
        depth_m: (H, W) float32, 0 where nothing was measured; none if it failed.
    """

    view: ViewProgress
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
