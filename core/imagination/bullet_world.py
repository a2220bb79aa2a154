"""One fresh Bullet world: the only place that steps the physics.

What made it fast and true was measured (docs/decisions/0001-physics-engine-settings.md): particles and object
as maximal-coordinate bodies, few solver iterations, short contacts, no ground (what falls past the object is
taken out), bodies driven with their velocity, and finer steps only while a particle is fast.
"""

from __future__ import annotations

from functools import cache
from math import ceil, hypot
from typing import Any

import numpy as np

from core.errors import WorkerError
from core.geometry import FloatArray, ellipsoid_inertia_kg_m2
from core.imagination.body import BodyFile
from core.imagination.engine import bullet
from core.imagination.particle_shape import ellipsoid_hull_m, ellipsoid_skin_m
from core.parameters.imagination import ContactParameters, ParticleParameters, SolverParameters

GRAVITY_M_S2 = 9.81
CHECK_STEPS = 4
"""Steps between two looks at the particles for those that fell or are fast."""
_REGION_MARGIN_M = 0.015
_SAFE_MOVE_M = 0.0009
"""Bullet sees a triangle from 1 mm away: a candy that moves on by more between two looks slips through it."""
_SAFE_SHARE_OF_RADIUS = 0.5
"""Of a ball, which a wall sees until its centre is through."""
_DRIVEN_MASS_KG = 1e4


@cache
def _server() -> int:
    """Connect this process to a physics server: anew for each world takes 15 ms, resetting it 1.5 ms."""
    client: int = bullet.connect(bullet.DIRECT)
    if client < 0:
        raise WorkerError("Bullet gave no physics server; close other simulations and try again.")
    return client


class BulletWorld:
    """A world with a few bodies that are not moved by particles, and a growing number of these."""

    def __init__(
        self,
        solver: SolverParameters,
        particle: ParticleParameters,
        contact: ContactParameters,
        region_m: FloatArray,
    ) -> None:
        """Start empty; `region_m` (2, 3) is the box that holds all bodies.

        Particles that fell below it are taken out, and only those in it count as fast: elsewhere there is
        nothing to slip through.
        """
        self._solver = solver
        self._particle = particle
        self._contact = contact
        self._region_m = (region_m + np.array([[-_REGION_MARGIN_M], [_REGION_MARGIN_M]])).tolist()
        self._skin_m = ellipsoid_skin_m(particle) if particle.shape == "ellipsoid" else 0.0
        self._safe_m_s = self._safe_move_m() * solver.rate_hz
        self._client = _server()
        self._substeps = 0
        self._steps = 0
        self.particle_ids: list[int | None] = []
        bullet.resetSimulation(physicsClientId=self._client)
        bullet.setPhysicsEngineParameter(
            fixedTimeStep=1 / solver.rate_hz,
            numSolverIterations=solver.iterations,
            numSubSteps=0,
            contactBreakingThreshold=solver.contact_breaking_m,
            deterministicOverlappingPairs=1,
            physicsClientId=self._client,
        )
        self.set_gravity(np.array([0.0, 0.0, -GRAVITY_M_S2]))
        self._shape = self._create_particle_shape()
        self._skin = self._skin_settings()
        # Without a visual of its own Bullet makes one from the shape, which takes longer than all the rest.
        self._visual: int = bullet.createVisualShape(
            bullet.GEOM_BOX, halfExtents=[0.001] * 3, physicsClientId=self._client
        )

    def __enter__(self) -> BulletWorld:
        return self

    def __exit__(self, *exception: object) -> None:
        bullet.resetSimulation(physicsClientId=self._client)

    def set_gravity(self, acceleration_m_s2: FloatArray) -> None:
        """Set the force field (3,), per mass."""
        self._gravity_m_s2 = acceleration_m_s2
        bullet.setGravity(*acceleration_m_s2.tolist(), physicsClientId=self._client)

    def add_fixed_body(self, body: BodyFile, restitution: float) -> None:
        """Add a body that rests at the origin."""
        self._add_body(body, restitution, 0.0)

    def add_driven_body(self, body: BodyFile, restitution: float) -> int:
        """Add a body that `drive` places before every step, and return its id.

        It is a very heavy dynamic body: for a static one Bullet ignores the velocity, so that a wall which
        moves against the particles neither carries nor stops them and they slip through.
        """
        return self._add_body(body, restitution, _DRIVEN_MASS_KG)

    def drive(
        self,
        body_id: int,
        position_m: FloatArray,
        quaternion: FloatArray,
        velocity_m_s: FloatArray,
        angular_velocity_rad_s: FloatArray,
    ) -> None:
        """Place a driven body for the next step, with the velocities that its motion has there."""
        bullet.resetBasePositionAndOrientation(
            body_id, position_m.tolist(), quaternion.tolist(), physicsClientId=self._client
        )
        bullet.resetBaseVelocity(
            body_id,
            velocity_m_s.tolist(),
            angular_velocity_rad_s.tolist(),
            physicsClientId=self._client,
        )
        # Held against the force field, in every part of the step.
        bullet.applyExternalForce(
            body_id,
            -1,
            (-_DRIVEN_MASS_KG * self._gravity_m_s2).tolist(),
            position_m.tolist(),
            bullet.WORLD_FRAME,
            physicsClientId=self._client,
        )

    def add_particle(self, pose: FloatArray, velocity: FloatArray | None = None) -> int:
        """Add a particle at `pose` (7,) with `velocity` (6,), linear then angular; return its index."""
        body_id = bullet.createMultiBody(
            self._particle.mass_kg,
            self._shape,
            self._visual,
            basePosition=pose[:3].tolist(),
            baseOrientation=pose[3:].tolist(),
            useMaximalCoordinates=1,
            physicsClientId=self._client,
        )
        bullet.changeDynamics(
            body_id,
            -1,
            lateralFriction=self._contact.lateral_friction,
            spinningFriction=self._contact.spinning_friction,
            rollingFriction=self._contact.rolling_friction,
            restitution=self._contact.restitution,
            activationState=bullet.ACTIVATION_STATE_DISABLE_SLEEPING,
            physicsClientId=self._client,
            **self._skin,
        )
        if velocity is not None:
            bullet.resetBaseVelocity(
                body_id, velocity[:3].tolist(), velocity[3:].tolist(), physicsClientId=self._client
            )
        self.particle_ids.append(body_id)
        return len(self.particle_ids) - 1

    def step(self) -> None:
        """Advance by one step; every few steps take out fallen particles and choose the fineness."""
        if self._steps % CHECK_STEPS == 0:
            self._look_after_particles()
        bullet.stepSimulation(physicsClientId=self._client)
        self._steps += 1

    def poses(self) -> FloatArray:
        """Return (N, 7) positions and quaternions of all particles, NaN for those taken out."""
        poses = np.full((len(self.particle_ids), 7), np.nan)
        for index, body_id in enumerate(self.particle_ids):
            if body_id is not None:
                position, quaternion = bullet.getBasePositionAndOrientation(
                    body_id, physicsClientId=self._client
                )
                poses[index] = (*position, *quaternion)
        return poses

    def pose_and_velocity(self, index: int) -> tuple[FloatArray, FloatArray]:
        """Return pose (7,) and velocity (6,) of a particle that is there."""
        body_id = self.particle_ids[index]
        position, quaternion = bullet.getBasePositionAndOrientation(body_id, physicsClientId=self._client)
        linear, angular = bullet.getBaseVelocity(body_id, physicsClientId=self._client)
        return np.array([*position, *quaternion]), np.array([*linear, *angular])

    def height_m(self, index: int) -> float:
        """Return the height of a particle's centre, minus infinity if it was taken out."""
        body_id = self.particle_ids[index]
        if body_id is None:
            return -np.inf
        height: float = bullet.getBasePositionAndOrientation(body_id, physicsClientId=self._client)[0][2]
        return height

    def remove_particle(self, index: int) -> None:
        """Take a particle out."""
        bullet.removeBody(self.particle_ids[index], physicsClientId=self._client)
        self.particle_ids[index] = None

    def top_speed_m_s(self) -> float:
        """Return the speed of the fastest particle."""
        ids = [body_id for body_id in self.particle_ids if body_id is not None]
        velocities = [bullet.getBaseVelocity(body_id, physicsClientId=self._client)[0] for body_id in ids]
        return max((hypot(*velocity) for velocity in velocities), default=0.0)

    def _look_after_particles(self) -> None:
        low, high = self._region_m
        top_speed_m_s = 0.0
        for index, body_id in enumerate(self.particle_ids):
            if body_id is None:
                continue
            (x, y, z), _ = bullet.getBasePositionAndOrientation(body_id, physicsClientId=self._client)
            if z < low[2]:
                self.remove_particle(index)
            elif self._solver.substeps > 1 and low[0] < x < high[0] and low[1] < y < high[1] and z < high[2]:
                velocity, _ = bullet.getBaseVelocity(body_id, physicsClientId=self._client)
                top_speed_m_s = max(top_speed_m_s, hypot(*velocity))
        self._set_substeps(min(ceil(top_speed_m_s / self._safe_m_s), self._solver.substeps))

    def _safe_move_m(self) -> float:
        """How far a particle may move in one computation without slipping through a wall (decision 0001)."""
        if self._particle.shape == "sphere":
            seen_m = _SAFE_SHARE_OF_RADIUS * self._particle.diameter_m / 2
        else:
            seen_m = self._skin_m  # a wall that is in the skin, and not yet in the hull, is still seen
        return max(_SAFE_MOVE_M, seen_m)

    def _set_substeps(self, substeps: int) -> None:
        """Compute each step in `substeps` parts; Bullet counts 0 as one."""
        if substeps != self._substeps:
            self._substeps = substeps
            bullet.setPhysicsEngineParameter(
                numSubSteps=substeps if substeps > 1 else 0, physicsClientId=self._client
            )

    def _add_body(self, body: BodyFile, restitution: float, mass_kg: float) -> int:
        shape = bullet.createCollisionShape(
            bullet.GEOM_MESH,
            fileName=body.path,
            flags=bullet.GEOM_FORCE_CONCAVE_TRIMESH if body.is_concave else 0,
            physicsClientId=self._client,
        )
        body_id: int = bullet.createMultiBody(
            mass_kg, shape, self._visual, useMaximalCoordinates=1, physicsClientId=self._client
        )
        # Bullet multiplies the two frictions of a contact: with 1 here the particle's own value counts.
        bullet.changeDynamics(
            body_id,
            -1,
            restitution=restitution,
            lateralFriction=1.0,
            linearDamping=0,
            angularDamping=0,
            activationState=bullet.ACTIVATION_STATE_DISABLE_SLEEPING,
            physicsClientId=self._client,
        )
        return body_id

    def _create_particle_shape(self) -> int:
        particle = self._particle
        if particle.shape == "sphere":
            arguments = {"shapeType": bullet.GEOM_SPHERE, "radius": particle.diameter_m / 2}
        elif particle.shape == "cylinder":
            arguments = {
                "shapeType": bullet.GEOM_CYLINDER,
                "radius": particle.diameter_m / 2,
                "height": particle.height_m,
            }
        else:
            skin_m = 2 * self._skin_m
            hull = ellipsoid_hull_m(particle.diameter_m - skin_m, particle.height_m - skin_m)
            arguments = {"shapeType": bullet.GEOM_MESH, "vertices": hull.tolist()}
        shape: int = bullet.createCollisionShape(**arguments, physicsClientId=self._client)
        return shape

    def _skin_settings(self) -> dict[str, Any]:
        """What `changeDynamics` must be told of a particle that is a hull in a skin."""
        if self._skin_m == 0:
            return {}
        particle = self._particle
        inertia = ellipsoid_inertia_kg_m2(particle.mass_kg, particle.diameter_m, particle.height_m)
        return {
            "mass": self._particle.mass_kg,
            "collisionMargin": self._skin_m,
            "localInertiaDiagonal": inertia.tolist(),
        }
