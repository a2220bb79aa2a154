"""The simulated table in MuJoCo: another engine, with another contact model and solver, as a second opinion.

Candies are exact ellipsoids, cylinders or spheres. The object's triangles are the elements of a rigid flex:
its surface is as it was given, `_SHELL_M` thicker. The cup's parts are convex hulls. A contact is a spring
with a damper: `contact_rad_s` says how stiff, the restitution how much it damps.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import atan2, exp, pi, sqrt
from typing import Any

import mujoco
import numpy as np
from scipy.optimize import brentq

from core.geometry import FloatArray
from core.imagination.cup import cup_parts
from core.mesh import TriangleMesh
from hardware.simulation.pour_outcome.bodies import GRAVITY_M_S2, Bodies
from hardware.simulation.pour_outcome.candies import Candies
from hardware.simulation.pour_outcome.settings import OutcomeSettings

_SHELL_M = 0.00005
"""Half the thickness of the object's triangles."""
_CUP_MASS_KG = 100.0
"""So heavy that candies do not move it; it is placed before each step."""
_FINE_ABOVE_M_S = 0.1
"""A candy that is faster, seen from the cup, may bounce: the step is computed in two parts."""
_CANDY, _CUP, _FIXED = 1, 2, 4
"""Bits of what touches what: candies everything, the cup and what is fixed only candies."""
_IMPEDANCE = (0.95, 0.95, 0.001, 0.5, 2.0)
_CCD_TOLERANCE_M = 1e-9
"""How exactly convex bodies are found to touch. With MuJoCo's own, 1e-6, one contact of ellipsoids in some
thousands is 2 mm deep where they just touch, and candies at rest jump (docs/decisions/0061)."""
_MEMORY_BYTES = 1 << 28
_LEAST_RESTITUTION = 0.15
"""No damping keeps less."""


@dataclass(frozen=True)
class _Contact:
    """How a wall meets candies: sliding friction and the share of the normal speed that is kept."""

    friction: float
    restitution: float


class MujocoTable:
    """One world, used as a context manager; it is built when it is first driven."""

    def __init__(self, bodies: Bodies, settings: OutcomeSettings) -> None:
        """Describe everything but the candies."""
        self._settings = settings
        self._spec = mujoco.MjSpec()
        self._model: Any = None
        self._data: Any = None
        self._describe_solver()
        self._add_table(bodies)
        self._add_object(bodies.object)
        self._add_cup(cup_parts(bodies.cup))

    def __enter__(self) -> MujocoTable:
        return self

    def __exit__(self, *exception: object) -> None:
        self._model = self._data = None

    def add_candies(self, candies: Candies) -> None:
        """Put candies where they are in the base frame; all of them before the first step."""
        for scale, position, quaternion in zip(
            candies.scales, candies.positions_m, candies.quaternions, strict=True
        ):
            self._add_candy(float(scale), position, quaternion)

    def drive_cup(
        self,
        position_m: FloatArray,
        quaternion: FloatArray,
        velocity_m_s: FloatArray,
        angular_velocity_rad_s: FloatArray,
    ) -> None:
        """Place the cup (3,), (4,) for the next step, with the velocities (3,), (3,) that take it on."""
        data = self._built()
        data.qpos[:3], data.qpos[3:7] = position_m, quaternion[[3, 0, 1, 2]]
        data.qvel[:3] = velocity_m_s
        # The rates of a free joint are seen from its body.
        rotation = np.zeros(9)
        mujoco.mju_quat2Mat(rotation, data.qpos[3:7])
        data.qvel[3:6] = rotation.reshape(3, 3).T @ angular_velocity_rad_s

    def step(self) -> None:
        """Advance by one step of 1 / `rate_hz`, in as many parts as the candies' speed asks for."""
        data = self._built()
        away_m_s = np.linalg.norm(self.velocities_m_s() - data.qvel[:3], axis=1).max(initial=0.0)
        slow_s = self._settings.slow_step_s
        parts_s = slow_s / 2 if away_m_s > _FINE_ABOVE_M_S else slow_s
        parts = max(round(1 / self._settings.rate_hz / parts_s), 1)
        self._model.opt.timestep = 1 / self._settings.rate_hz / parts
        for _ in range(parts):
            mujoco.mj_step(self._model, data)

    def poses(self) -> FloatArray:
        """Return (N, 7) positions and quaternions (x, y, z, w) of the candies."""
        poses: FloatArray = self._built().qpos[7:].reshape(-1, 7)[:, [0, 1, 2, 4, 5, 6, 3]].copy()
        return poses

    def velocities_m_s(self) -> FloatArray:
        """Return (N, 3) velocities of the candies' centres."""
        velocities: FloatArray = self._built().qvel[6:].reshape(-1, 6)[:, :3].copy()
        return velocities

    def _built(self) -> Any:
        if self._data is None:
            self._model = self._spec.compile()
            self._data = mujoco.MjData(self._model)
        return self._data

    def _describe_solver(self) -> None:
        option = self._spec.option
        option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        option.solver = mujoco.mjtSolver.mjSOL_CG
        option.jacobian = mujoco.mjtJacobian.mjJAC_SPARSE
        option.iterations = self._settings.iterations
        option.ccd_tolerance = _CCD_TOLERANCE_M
        option.gravity = [0.0, 0.0, -GRAVITY_M_S2]
        self._spec.memory = _MEMORY_BYTES

    def _add_table(self, bodies: Bodies) -> None:
        settings = self._settings
        contact = _Contact(settings.table_friction, settings.wall_restitution)
        plane = self._spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], pos=[0, 0, bodies.table_height_m]
        )
        low, high = bodies.platform_box_m
        box = self._spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX, size=(high - low) / 2, pos=(low + high) / 2
        )
        for geom in (plane, box):
            self._set_wall(geom, contact, _FIXED)

    def _add_object(self, mesh: TriangleMesh) -> None:
        settings = self._settings
        flex = self._spec.add_flex(name="object")
        flex.dim, flex.radius = 2, _SHELL_M
        flex.vertbody = ["world"]
        flex.vert, flex.elem = mesh.vertices_m.ravel().tolist(), mesh.faces.ravel().tolist()
        flex.selfcollide = mujoco.mjtFlexSelf.mjFLEXSELF_NONE
        self._set_wall(flex, _Contact(settings.object_friction, settings.wall_restitution), _FIXED)

    def _add_cup(self, parts: tuple[TriangleMesh, ...]) -> None:
        settings = self._settings
        body = self._spec.worldbody.add_body(name="cup", gravcomp=1.0)
        body.add_freejoint()
        body.explicitinertial, body.mass, body.inertia = True, _CUP_MASS_KG, [1.0, 1.0, 1.0]
        body.ipos, body.iquat = [0, 0, 0], [1, 0, 0, 0]
        contact = _Contact(settings.cup_friction, settings.wall_restitution)
        for number, part in enumerate(parts):
            mesh = self._spec.add_mesh(name=f"cup_{number}", uservert=part.vertices_m.ravel())
            mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
            geom = body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=f"cup_{number}", mass=0)
            self._set_wall(geom, contact, _CUP)

    def _add_candy(self, scale: float, position_m: FloatArray, quaternion: FloatArray) -> None:
        settings = self._settings
        body = self._spec.worldbody.add_body(pos=position_m, quat=quaternion[[3, 0, 1, 2]])
        body.add_freejoint()
        radius_m, half_m = scale * settings.candy_diameter_m / 2, scale * settings.candy_height_m / 2
        kind, size = {
            "lentil": (mujoco.mjtGeom.mjGEOM_ELLIPSOID, [radius_m, radius_m, half_m]),
            "tablet": (mujoco.mjtGeom.mjGEOM_CYLINDER, [radius_m, half_m, 0]),
            "ball": (mujoco.mjtGeom.mjGEOM_SPHERE, [radius_m, 0, 0]),
        }[settings.candy_shape]
        geom = body.add_geom(type=kind, size=size, mass=settings.candy_mass_kg * scale**3)
        geom.contype, geom.conaffinity = _CANDY, _CANDY | _CUP | _FIXED
        geom.condim = 3
        self._set_contact(geom, _Contact(settings.candy_friction, settings.candy_restitution))

    def _set_wall(self, geom: Any, contact: _Contact, bit: int) -> None:
        geom.contype, geom.conaffinity = bit, _CANDY
        geom.priority = 1  # a wall's contact with a candy is the wall's
        geom.condim = 6  # resists rolling and spinning, too
        geom.friction[1:] = self._settings.rolling_arm_m
        self._set_contact(geom, contact)

    def _set_contact(self, geom: Any, contact: _Contact) -> None:
        """Coulomb friction, and a damped spring along the normal."""
        damping = damping_ratio(contact.restitution)
        geom.friction[0] = contact.friction
        geom.solref[:2] = [1 / (self._settings.contact_rad_s * damping), damping]
        geom.solimp[:] = _IMPEDANCE


@cache
def damping_ratio(restitution: float) -> float:
    """Return the damping of a spring that can only push, on which a mass keeps that share of its speed.

    Schwager and Poeschel, "Coefficient of restitution and linear-dashpot model revisited", 2007.
    """
    wanted = max(restitution, _LEAST_RESTITUTION)

    def kept(damping: float) -> float:
        root = sqrt(1 - damping * damping)
        until = pi - atan2(2 * damping * root, 1 - 2 * damping * damping)
        return exp(-damping / root * until) - wanted

    return float(brentq(kept, 1e-6, 0.999))
