"""Which controller is simulated, and where it listens."""

from __future__ import annotations

from dataclasses import dataclass

from core.errors import InputError
from core.motion.arm_models import UR5, UR5E, ArmModel

MODELS = {arm.name: arm for arm in (UR5, UR5E)}
_CB3_HZ, _E_SERIES_HZ = 125, 500
_REMOTE_CONTROL_SINCE = (5, 6)


@dataclass(frozen=True)
class Identity:
    """What the controller reports itself to be.

    Attributes:
        model: of the arm.
        version: of PolyScope: major, minor.
    """

    model: ArmModel
    version: tuple[int, int]

    @property
    def rate_hz(self) -> int:
        """Cycles per second: CB3 runs at 125 Hz, e-Series at 500 Hz."""
        return _E_SERIES_HZ if self.version[0] >= 5 else _CB3_HZ

    @property
    def is_e_series(self) -> bool:
        """Whether it is one."""
        return self.version[0] >= 5

    @property
    def knows_remote_control(self) -> bool:
        """Whether it distinguishes local from remote control."""
        return self.version >= _REMOTE_CONTROL_SINCE

    @property
    def version_text(self) -> str:
        """As the dashboard reports it."""
        major, minor = self.version
        number = f"{major}.{minor}.0.0"
        return f"URSoftware {number} (Jan 01 2024)" if self.is_e_series else number


def identity(model: str, version: str) -> Identity:
    """Return the identity of a model ("UR5", "UR5e") and a PolyScope version ("3.15", "5.11").

    Raises:
        InputError: an unknown model, or a version that is not one.
    """
    if model not in MODELS:
        raise InputError(f"There is no arm '{model}' to simulate; choose one of {', '.join(MODELS)}.")
    parts = version.split(".")
    if len(parts) < 2 or not all(part.isdigit() for part in parts):
        raise InputError(f"'{version}' is not a version of PolyScope; write for example 3.15 or 5.11.")
    return Identity(MODELS[model], (int(parts[0]), int(parts[1])))


"""Where the controller listens, and where its arm is at first."""

DASHBOARD_PORT = 29999
PRIMARY_PORT = 30001
SCRIPT_PORT = 30003
RTDE_PORT = 30004
CONTROL_PORT = 30099
"""The first four are a real controller's; the last takes faults and questions."""
HOME_RAD = (0.0, -1.5708, 1.5708, -1.5708, -1.5708, 0.0)
