"""What a structured-light camera does to a true depth image.

Axial noise: Nguyen, Izadi and Lovell, "Modeling Kinect Sensor Noise for Improved 3D Reconstruction and
Tracking", 3DIMPVT 2012, eq. 2 and 3. The factor, the correlation and the disparity step were set so that
patches of a table look as in the 24 real views of the authors' tray, which a test compares.
"""

from __future__ import annotations

from math import radians

import numpy as np

from core.geometry import FloatArray, make_pose
from core.parameters.fields import OURS, Group, quantity

_TRAY = f"{OURS}: set so that table patches look as in the released tray scan"


class DepthNoise(Group):
    """Everything that keeps the simulated camera from being perfect; `None` in its place is a perfect one."""

    axial_scale: float = quantity(
        0.5,
        "Factor on the axial noise of Nguyen et al.; the Carmine is better than their Kinect.",
        unit="",
        source=_TRAY,
        low=0,
        high=10,
    )
    correlation_px: float = quantity(
        1.5,
        "SD of the Gaussian over which neighbouring pixels share their noise: the camera matches windows.",
        unit="pixel",
        source=_TRAY,
        low=0,
        high=20,
    )
    disparity_step_per_m: float = quantity(
        0.003,
        "Step of inverse depth; 0.003 per metre makes steps of 3 mm at 1 m and 12 mm at 2 m.",
        unit="1/m",
        source="measured on the released tray scan",
        low=0,
        high=0.1,
    )
    depth_step_m: float = quantity(
        0.001, "Step in which the device hands its depth out.", unit="m", source="OpenNI2", low=0, high=0.1
    )
    baseline_m: float = quantity(
        0.075,
        "Distance of the projector, along +x of the camera; what it does not light has no depth.",
        unit="m",
        source="PrimeSense Carmine 1.09",
        low=0,
        high=0.3,
    )
    max_incidence_rad: float = quantity(
        radians(78),
        "Surfaces seen at a flatter angle give no depth.",
        unit="rad",
        source=OURS,
        low=0,
        high=1.58,
    )
    min_range_m: float = quantity(
        0.35, "Nothing nearer is measured.", unit="m", source="PrimeSense Carmine 1.09", low=0, high=2
    )
    pose_position_m: float = quantity(
        0.001,
        "Length (root mean square) of the error in each view's recorded position.",
        unit="m",
        source=OURS,
        low=0,
        high=0.1,
    )
    pose_angle_rad: float = quantity(
        radians(0.25),
        "Angle (root mean square) of the error in each view's recorded orientation.",
        unit="rad",
        source=OURS,
        low=0,
        high=0.5,
    )


def axial_sd_m(depth_m: FloatArray, incidence_rad: FloatArray) -> FloatArray:
    """SD of the depth along the optical axis after Nguyen et al. 2012, eq. 2 (first 60 degrees) and 3."""
    sd = 0.0012 + 0.0019 * (depth_m - 0.4) ** 2
    slanted = incidence_rad > radians(60)
    angle = np.minimum(incidence_rad[slanted], radians(89))
    sd[slanted] += 0.0001 / np.sqrt(depth_m[slanted]) * (angle / (np.pi / 2 - angle)) ** 2
    return sd


def disturb(
    depth_m: FloatArray, incidence_rad: FloatArray, noise: DepthNoise, random: np.random.Generator
) -> FloatArray:
    """Return a depth image (H, W) as the device gives it; 0 stays 0 and is where nothing was measured."""
    measured: FloatArray = np.zeros_like(depth_m)
    seen = (depth_m > 0) & (depth_m >= noise.min_range_m) & (incidence_rad <= noise.max_incidence_rad)
    deviates = _correlated(depth_m.shape, noise.correlation_px, random)[seen]
    noisy = depth_m[seen] + noise.axial_scale * axial_sd_m(depth_m[seen], incidence_rad[seen]) * deviates
    measured[seen] = _in_steps(noisy, noise)
    return measured


def disturb_pose(T_base_camera: FloatArray, noise: DepthNoise, random: np.random.Generator) -> FloatArray:
    """Return where the camera really is when it is believed to be at `T_base_camera`."""
    from scipy.spatial.transform import Rotation

    # A vector of three independent parts is sqrt(3) times as long as each of them.
    turn = random.normal(scale=noise.pose_angle_rad / np.sqrt(3), size=3)
    shift = random.normal(scale=noise.pose_position_m / np.sqrt(3), size=3)
    return T_base_camera @ make_pose(Rotation.from_rotvec(turn).as_matrix(), shift)


def _correlated(shape: tuple[int, ...], sd_px: float, random: np.random.Generator) -> FloatArray:
    """Standard normal deviates, shared between neighbours."""
    from scipy.ndimage import gaussian_filter

    deviates = random.standard_normal(shape, dtype=np.float32)
    if sd_px > 0:
        smooth = gaussian_filter(deviates, sd_px, mode="wrap", truncate=3)
        deviates = smooth / smooth.std()
    return deviates.astype(float)


def _in_steps(depth_m: FloatArray, noise: DepthNoise) -> FloatArray:
    step = noise.disparity_step_per_m
    if step > 0:
        depth_m = 1 / (np.maximum(np.round(1 / depth_m / step), 1) * step)
    if noise.depth_step_m > 0:
        depth_m = np.round(depth_m / noise.depth_step_m) * noise.depth_step_m
    return depth_m
