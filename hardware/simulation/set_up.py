"""What a simulated set-up really is, other than its cell file believes: what a calibration has to find."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from math import radians

import numpy as np

from core.calibration.lens import Lens
from core.geometry import FloatArray, make_pose
from core.motion.arm_models import ArmModel
from core.motion.factory_calibration import MeasuredKinematics, calibrated
from core.parameters.fields import OURS, Group, choice, quantity
from core.scan.model import Intrinsics

Row = tuple[float, float, float, float]


class SetUp(Group):
    """The truth about a simulated camera, arm and calibration board."""

    T_flange_camera: tuple[Row, Row, Row, Row] = choice(
        ..., "Where the camera really hangs: takes camera points to the flange.", source=OURS
    )
    board_middle_m: tuple[float, float, float] = quantity(
        ..., "Where the middle of the calibration board lies.", unit="m", source=OURS, low=None
    )
    board_yaw_rad: float = quantity(
        0.4, "How the board is turned about the vertical.", unit="rad", source=OURS
    )
    square_m: float = quantity(
        0.030,
        "Side of a square of the board as it came out of the printer.",
        unit="m",
        source=OURS,
        low=0.005,
    )
    arm_position_m: float = quantity(
        0.0003, "SD per axis of where the flange is, from one place to the next.",
        unit="m", source=OURS, low=0, high=0.05,
    )  # fmt: skip
    arm_angle_rad: float = quantity(
        radians(0.03), "SD per axis of its orientation.", unit="rad", source=OURS, low=0, high=0.5
    )
    link_error_m: float = quantity(
        0.0, "SD by which lengths and offsets of the arm's links differ from the published ones.",
        unit="m", source=OURS, low=0, high=0.02,
    )  # fmt: skip
    link_error_rad: float = quantity(
        0.0, "SD by which twists of its links and zeros of its joints differ.",
        unit="rad", source=OURS, low=0, high=0.1,
    )  # fmt: skip
    distortion: tuple[float, float, float, float, float] = choice(
        (0.0, 0.0, 0.0, 0.0, 0.0), "Of the lens: k1, k2, p1, p2, k3.", source=OURS
    )
    blur_px: float = quantity(0.6, "SD of the image's blur.", unit="pixel", source=OURS, low=0, high=20)
    noise_levels: float = quantity(
        2.0, "SD of a pixel's brightness, of 255.", unit="", source=OURS, low=0, high=100
    )
    seed: int = quantity(0, "Of the arm's own errors.", unit="", source=OURS, low=0)

    @property
    def camera_pose(self) -> FloatArray:
        """`T_flange_camera` (4, 4)."""
        return np.array(self.T_flange_camera)

    def lens(self, intrinsics: Intrinsics) -> Lens:
        """Return the lens before the image sensor."""
        return Lens(intrinsics, self.distortion)

    def measured(self, arm: ArmModel) -> MeasuredKinematics | None:
        """Return what the maker of this very arm measured, as its controller tells; none: it is as published.

        Args:
            arm: as published.
        """
        if not (self.link_error_m or self.link_error_rad):
            return None
        random = np.random.default_rng([self.seed, 1])
        a_m, d_m = (
            (np.array(nominal) + random.normal(0, self.link_error_m, 6)).tolist()
            for nominal in (arm.a_m, arm.d_m)
        )
        alpha_rad = (np.array(arm.alpha_rad) + random.normal(0, self.link_error_rad, 6)).tolist()
        theta_rad = random.normal(0, self.link_error_rad, 6).tolist()
        rows = list(zip(theta_rad, a_m, d_m, alpha_rad, strict=True))
        checksum = tuple(link_checksum(row) for row in rows)
        return MeasuredKinematics(tuple(theta_rad), tuple(a_m), tuple(d_m), tuple(alpha_rad), checksum)

    def own_arm(self, arm: ArmModel) -> ArmModel:
        """Return the model of this very arm, from the published one.

        Raises:
            MotionError: its links differ by more than those of one arm do from another's.
        """
        measured = self.measured(arm)
        return arm if measured is None else calibrated(arm, measured)

    def flexed(self, T_base_flange: FloatArray, random: np.random.Generator) -> FloatArray:
        """Return where the flange ends up that should be at a pose (4, 4)."""
        from scipy.spatial.transform import Rotation

        turn = Rotation.from_rotvec(random.normal(0, self.arm_angle_rad, 3)).as_matrix()
        return T_base_flange @ make_pose(turn, random.normal(0, self.arm_position_m, 3))


def random_camera_pose(
    T_flange_camera: FloatArray, seed: int, most_m: float = 0.020, most_rad: float = radians(10)
) -> FloatArray:
    """Return where a camera (4, 4) may really hang that is believed to be at a pose (4, 4)."""
    from scipy.spatial.transform import Rotation

    random = np.random.default_rng([seed, 2])
    turn, shift = random.normal(size=3), random.normal(size=3)
    turn *= most_rad * random.uniform() ** (1 / 3) / np.linalg.norm(turn)
    shift *= most_m * random.uniform() ** (1 / 3) / np.linalg.norm(shift)
    return T_flange_camera @ make_pose(Rotation.from_rotvec(turn).as_matrix(), shift)


def link_checksum(link: Sequence[float]) -> int:
    """What tells one arm's link from another's: of its theta, a, d and alpha."""
    return zlib.crc32(struct.pack(">4d", *link))
