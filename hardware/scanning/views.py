"""The views of a scan: what is planned, and what became of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from core.scan.model import CropBox

Joints = tuple[float, ...]


class ViewState(Enum):
    """What became of a view."""

    PENDING = "pending"
    TAKEN = "taken"
    POOR = "poor"
    FAILED = "failed"


@dataclass(frozen=True)
class PlannedView:
    """Where the arm is to be for an image.

    Attributes:
        name: the frame's, such as `frame-000003`.
        joints_rad: (6,).
    """

    name: str
    joints_rad: Joints


@dataclass(frozen=True)
class ViewRecord:
    """A planned view and what became of it; poor and failed ones come with the reasons.

    Attributes:
        view: what was planned.
        state: what became of it; a poor one was taken, and counts, but deserves another try.
        problems: a plain sentence each.
    """

    view: PlannedView
    state: ViewState = ViewState.PENDING
    problems: tuple[str, ...] = ()

    @property
    def has_image(self) -> bool:
        """Whether there is an image of it."""
        return self.state in (ViewState.TAKEN, ViewState.POOR)


@dataclass(frozen=True)
class ScanPlan:
    """From where an object is scanned.

    Attributes:
        views_rad: joints of the views, in their order.
        crop_box: what of the images belongs to the object.
        keep_out: the box that the arm keeps clear of.
    """

    views_rad: tuple[Joints, ...]
    crop_box: CropBox
    keep_out: CropBox


def name_views(joints_rad: Sequence[Joints], first: int = 0) -> tuple[PlannedView, ...]:
    """Return views named by their order, counted from `first`."""
    return tuple(PlannedView(f"frame-{first + k:06d}", tuple(row)) for k, row in enumerate(joints_rad))
