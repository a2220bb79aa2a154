"""How exact corners and arm are, estimated from the residuals of the views themselves.

The corners of one view share the error of the arm's pose: taken as independent they would promise an accuracy
that is several times too good. So each view's corners have the covariance `s^2 I + J diag(a^2, p^2) J^T`,
with the corners' error s, and the arm's angular and linear errors a and p per axis. s follows from what no
pose of the board explains; a and p by restricted maximum likelihood (Patterson and Thompson 1971).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from core.calibration.rig import Derivatives
from core.geometry import FloatArray

_SPREAD = np.log(3.0)
"""The arm's errors are expected within a factor of 3; a few views can say otherwise."""
_LEAST_CORNER_PX = 0.02


@dataclass(frozen=True)
class Noise:
    """Standard deviations per axis.

    Attributes:
        corner_px: of a corner's coordinates.
        arm_angle_rad: of the flange's orientation.
        arm_position_m: of its position.
    """

    corner_px: float
    arm_angle_rad: float
    arm_position_m: float

    @property
    def arm_covariance(self) -> FloatArray:
        """Covariance (6, 6) of a view's pose: rotation, then translation."""
        return np.diag([self.arm_angle_rad**2] * 3 + [self.arm_position_m**2] * 3)


EXPECTED = Noise(0.2, float(np.radians(0.03)), 0.0003)
"""What a UR5 with its own kinematics and a sharp image come to."""


@dataclass(frozen=True)
class PoseErrors:
    """The residuals of V views as errors of the arm's pose: all that they tell of the rig.

    Attributes:
        errors: (V, 6) of each view's pose, rotation before translation, in the flange frame.
        by_unknowns: (V, 6, K) how they change with the rig.
        shape: (V, 6, 6) their covariance for corners' errors of 1 px.
        left_px: (V,) root mean square per coordinate of what no pose explains.
    """

    errors: FloatArray
    by_unknowns: FloatArray
    shape: FloatArray
    left_px: FloatArray

    def covariances(self, noise: Noise) -> FloatArray:
        """Covariances (V, 6, 6) of the errors."""
        return np.asarray(noise.corner_px**2 * self.shape + noise.arm_covariance)


def pose_errors(views: Sequence[Derivatives]) -> PoseErrors:
    """Project the residuals of views on the poses that explain them best."""
    errors, by_unknowns, shapes, left = [], [], [], []
    for view in views:
        shape = np.linalg.inv(view.by_flange.T @ view.by_flange)
        to_pose = shape @ view.by_flange.T
        errors.append(to_pose @ view.residuals_px)
        by_unknowns.append(to_pose @ view.by_unknowns)
        shapes.append(shape)
        rest = view.residuals_px - view.by_flange @ errors[-1]
        left.append(np.sqrt(rest @ rest / max(len(rest) - 6, 1)))
    return PoseErrors(np.array(errors), np.array(by_unknowns), np.array(shapes), np.array(left))


def distances(poses: PoseErrors, noise: Noise) -> FloatArray:
    """Squared Mahalanobis distance (V,) of each view's error; 6 on average."""
    solved = np.linalg.solve(poses.covariances(noise), poses.errors[..., None])[..., 0]
    return np.asarray(np.einsum("vi,vi->v", poses.errors, solved))


def estimate_noise(poses: PoseErrors, weights: FloatArray) -> Noise:
    """Estimate the noise of views with weights (V,), each from 0 to 1."""
    from scipy.optimize import minimize

    corner_px = max(float(np.median(poses.left_px)), _LEAST_CORNER_PX)
    expected = np.log([EXPECTED.arm_angle_rad, EXPECTED.arm_position_m])

    def cost(logarithms: FloatArray) -> float:
        noise = Noise(corner_px, *np.exp(logarithms).tolist())
        return _restricted_cost(poses, noise, weights) + float(
            (((logarithms - expected) / _SPREAD) ** 2).sum()
        )

    found = minimize(cost, expected, method="Nelder-Mead", options={"xatol": 0.01, "fatol": 0.01})
    return Noise(corner_px, *np.exp(found.x).tolist())


def _restricted_cost(poses: PoseErrors, noise: Noise, weights: FloatArray) -> float:
    """Twice the negative logarithm of the restricted likelihood, up to a constant."""
    covariances = poses.covariances(noise)
    by_unknowns = poses.by_unknowns * np.sqrt(weights)[:, None, None]
    errors = poses.errors * np.sqrt(weights)[:, None]
    solved = np.linalg.solve(covariances, np.concatenate([by_unknowns, errors[..., None]], axis=-1))
    information = np.einsum("vik,vil->kl", by_unknowns, solved[..., :-1])
    score = np.einsum("vik,vi->k", by_unknowns, solved[..., -1])
    total = np.einsum("vi,vi->", errors, solved[..., -1])
    explained = score @ np.linalg.lstsq(information, score, rcond=None)[0]
    logarithm = (weights * np.linalg.slogdet(covariances)[1]).sum() + np.linalg.slogdet(information)[1]
    return float(logarithm + total - explained)
