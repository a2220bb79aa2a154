"""How diverse the arm's rotations are: they, not the number of views, decide what a calibration is worth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from core.geometry import FloatArray

LEAST_LEVER = 0.2
GOOD_LEVER = 0.3
_LITTLE_RAD = np.radians(10.0)
_AXES = (
    "nodding (about the image's horizontal axis)",
    "swinging left and right (about the image's vertical axis)",
    "rolling (about the line of sight)",
)


class Grade(Enum):
    """What rotations are worth."""

    GOOD = "good"
    WEAK = "weak"
    POOR = "too similar"


@dataclass(frozen=True)
class Diversity:
    """The rotations of a set of views.

    The camera's place follows from how far the arm's rotations swing it. With R the mean of the flange's
    rotations, `S = I - R^T R` is how much each direction of the flange is swung, 0 to 1; a direction that is
    not swung at all is undetermined (Tsai and Lenz, IEEE Trans. Robotics and Automation 1989, need two axes).

    Attributes:
        lever: square root of the smallest eigenvalue of S, about the sine of the angle by which the direction
            that is swung least is swung.
        about_rad: (3,) about how far, root mean square, the camera is rotated about its own x, y and z.
    """

    lever: float
    about_rad: tuple[float, float, float]

    @property
    def grade(self) -> Grade:
        """Whether they are enough."""
        if self.lever < LEAST_LEVER:
            return Grade.POOR
        return Grade.GOOD if self.lever >= GOOD_LEVER else Grade.WEAK

    @property
    def missing(self) -> tuple[str, ...]:
        """Names of the rotations of the camera that are missing, the most wanted first; none if good."""
        if self.grade is Grade.GOOD:
            return ()
        order = np.argsort(self.about_rad)
        little = [k for k in order if self.about_rad[k] < _LITTLE_RAD]
        return tuple(_AXES[k] for k in (little or order[:2]))

    @property
    def sentence(self) -> str:
        """For people."""
        about = ", ".join(
            f"{name} {np.degrees(a):.0f}" for name, a in zip("xyz", self.about_rad, strict=True)
        )
        said = f"The rotations are {self.grade.value} (about the camera's {about} degrees)."
        return said + (f" Missing: {'; '.join(self.missing)}." if self.missing else "")


def diversity(T_base_flange: Sequence[FloatArray], T_flange_camera: FloatArray) -> Diversity:
    """Grade poses (V, 4, 4) of the flange; the hand-eye pose may be a guess, it only names the axes."""
    cameras = np.array(T_base_flange)[:, :3, :3] @ T_flange_camera[:3, :3]
    mean = cameras.mean(axis=0)
    swung = np.eye(3) - mean.T @ mean
    lever = float(np.sqrt(max(np.linalg.eigvalsh(swung)[0], 0.0)))
    # For small rotations w, S is the mean of |w|^2 I - w w^T.
    squares = np.maximum(np.trace(swung) / 2 - np.diag(swung), 0)
    x, y, z = np.sqrt(squares).tolist()
    return Diversity(lever, (x, y, z))
