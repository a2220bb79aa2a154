"""One fresh Bullet world: the only place that steps the physics.

What made it fast and true was measured (docs/decisions/0001-physics-engine-settings.md): particles and object
as maximal-coordinate bodies, few solver iterations, short contacts, no ground (what falls past the object is
taken out), bodies driven with their velocity, finer steps only while a particle is fast, and continuous
collision detection for those that still move far in one of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import ceil, hypot, sqrt

import numpy as np

from core.errors import WorkerError
from core.geometry import FloatArray
from core.imagination.body import BodyFile
from core.imagination.engine import bullet
from core.imagination.particle_shape import shape_of
from core.parameters.bodies import ContactParameters, ParticleParameters, SolverParameters

GRAVITY_M_S2 = 9.81
CHECK_STEPS = 4
"""Steps between two looks at the particles for those that fell or are fast."""
RESTING_M_S = 0.03
"""Slower than that nothing leaves any more: the same counts as with 0.01 m/s, up to 1.6 times faster."""
_REGION_MARGIN_M = 0.015
_DRIVEN_MASS_KG = 1e4
_SWEEP_TOLERANCE_M = 0.0002
"""Bullet's own is 40 mm, with which its continuous collision detection never sees a candy's way end."""


@dataclass(frozen=True)
class _Surfaces:
    """What each body gets so that every pair has the contact that was asked for.

    Bullet multiplies the two bodies' sliding frictions and restitutions. Its friction against rolling and
    spinning is each body's value times the other's sliding friction, added up: here only candies have one.
    """

    candy_friction: float
    wall_friction: float
    candy_spinning: float
    candy_rolling: float
    restitution: float

    @classmethod
    def of(cls, contact: ContactParameters) -> _Surfaces:
        candy = sqrt(contact.candy_friction)
        wall = contact.lateral_friction / candy
        rolls = wall > 0
        return cls(
            candy,
            wall,
            contact.spinning_friction / wall if rolls else 0.0,
            contact.rolling_friction / wall if rolls else 0.0,
            sqrt(contact.restitution),
        )


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
        self._surfaces = _Surfaces.of(contact)
        self._region_m = (region_m + np.array([[-_REGION_MARGIN_M], [_REGION_MARGIN_M]])).tolist()
        self._safe_m_s = shape_of(particle).safe_move_m(particle) * solver.rate_hz
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
            allowedCcdPenetration=_SWEEP_TOLERANCE_M,
            deterministicOverlappingPairs=1,
            physicsClientId=self._client,
        )
        self.set_gravity(np.array([0.0, 0.0, -GRAVITY_M_S2]))
        self._shape = self._create_particle_shape()
        self._dynamics = shape_of(particle).dynamics(particle)
        if solver.substeps > 1:  # without: the released code's physics, as it was
            self._dynamics["ccdSweptSphereRadius"] = shape_of(particle).swept_radius_m(particle)
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

    def add_fixed_body(self, body: BodyFile) -> None:
        """Add a body that rests at the origin."""
        self._add_body(body, 0.0)

    def add_driven_body(self, body: BodyFile) -> int:
        """Add a body that `drive` places before every step, and return its id.

        It is a very heavy dynamic body: for a static one Bullet ignores the velocity, so that a wall which
        moves against the particles neither carries nor stops them and they slip through.
        """
        return self._add_body(body, _DRIVEN_MASS_KG)

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
            lateralFriction=self._surfaces.candy_friction,
            spinningFriction=self._surfaces.candy_spinning,
            rollingFriction=self._surfaces.candy_rolling,
            restitution=self._surfaces.restitution,
            activationState=bullet.ACTIVATION_STATE_DISABLE_SLEEPING,
            physicsClientId=self._client,
            **self._dynamics,
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

    def is_at_rest(self, below_m_s: float = RESTING_M_S) -> bool:
        """Return whether all particles are slower than that."""
        return self.top_speed_m_s() < below_m_s

    def speeds_m_s(self) -> FloatArray:
        """Return (N,) the speeds of all particles, NaN for those taken out."""
        speeds = np.full(len(self.particle_ids), np.nan)
        for index, body_id in enumerate(self.particle_ids):
            if body_id is not None:
                speeds[index] = hypot(*bullet.getBaseVelocity(body_id, physicsClientId=self._client)[0])
        return speeds

    def top_speed_m_s(self) -> float:
        """Return the speed of the fastest particle."""
        return float(np.nanmax(self.speeds_m_s(), initial=0.0))

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

    def _set_substeps(self, substeps: int) -> None:
        """Compute each step in `substeps` parts; Bullet counts 0 as one."""
        if substeps != self._substeps:
            self._substeps = substeps
            bullet.setPhysicsEngineParameter(
                numSubSteps=substeps if substeps > 1 else 0, physicsClientId=self._client
            )

    def _add_body(self, body: BodyFile, mass_kg: float) -> int:
        shape = bullet.createCollisionShape(
            bullet.GEOM_MESH,
            fileName=body.path,
            flags=bullet.GEOM_FORCE_CONCAVE_TRIMESH if body.is_concave else 0,
            physicsClientId=self._client,
        )
        body_id: int = bullet.createMultiBody(
            mass_kg, shape, self._visual, useMaximalCoordinates=1, physicsClientId=self._client
        )
        bullet.changeDynamics(
            body_id,
            -1,
            restitution=self._surfaces.restitution,
            lateralFriction=self._surfaces.wall_friction,
            linearDamping=0,
            angularDamping=0,
            activationState=bullet.ACTIVATION_STATE_DISABLE_SLEEPING,
            physicsClientId=self._client,
        )
        return body_id

    def _create_particle_shape(self) -> int:
        arguments = shape_of(self._particle).collision(self._particle)
        shape: int = bullet.createCollisionShape(**arguments, physicsClientId=self._client)
        return shape
