"""The simulated table in Bullet: object, platform and table at rest, the driven cup, and the candies.

It is a world of its own, not the imagination's: none of the settings is shared, and each is given explicitly.
What was measured for that one holds here too (docs/decisions/0001 and 0002): a driven body is a very heavy
dynamic one that is placed before each step, and candies that are fast near walls get finer steps.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np

from core.errors import WorkerError
from core.geometry import BoolArray, FloatArray, invert_pose, make_pose, transform_points
from core.imagination.body import BodyFile
from core.imagination.engine import bullet
from core.parameters.imagination import CupParameters
from hardware.simulation.pour_outcome.candies import Candies, hull_m, inertia_kg_m2, skin_m
from hardware.simulation.pour_outcome.lying import LyingCandies
from hardware.simulation.pour_outcome.settings import OutcomeSettings

GRAVITY_M_S2 = 9.80665
_DRIVEN_MASS_KG = 1e4
_LOOK_STEPS = 4
"""Steps between two looks at how fast the candies are."""
_NEAR_M = 0.02
"""From the walls of cup or object: this far away a candy may be fast."""
_TABLE_DEPTH_M = 1.0


@dataclass(frozen=True)
class PlatformBox:
    """The platform on the table, along the base's axes.

    Attributes:
        min_m: (2,) lower corner, x and y.
        max_m: (2,) upper corner.
        height_m: of its top, in the base frame.
    """

    min_m: tuple[float, float]
    max_m: tuple[float, float]
    height_m: float


@dataclass(frozen=True)
class Bodies:
    """Everything in the world but the candies.

    Attributes:
        object_file: the true surface, in the base frame.
        aabb_m: (2, 3) the object's AABB.
        cup_file: the cup as convex parts, in its own frame.
        cup: its measures.
        table_height_m: of the table's top.
        platform: the box that carries the object.
    """

    object_file: BodyFile
    aabb_m: FloatArray
    cup_file: BodyFile
    cup: CupParameters
    table_height_m: float
    platform: PlatformBox


class TableWorld:
    """One world in a physics server of its own, used as a context manager."""

    def __init__(self, bodies: Bodies, settings: OutcomeSettings) -> None:
        """Build everything but the candies.

        Raises:
            WorkerError: Bullet gave no server.
        """
        self._bodies = bodies
        self._settings = settings
        self._client: int = bullet.connect(bullet.DIRECT)
        if self._client < 0:
            raise WorkerError("Bullet gave no physics server; close other simulations and try again.")
        self._substeps = 0
        self._steps = 0
        self._candies: list[int] = []
        bullet.setPhysicsEngineParameter(
            fixedTimeStep=1 / settings.rate_hz,
            numSolverIterations=settings.iterations,
            contactBreakingThreshold=settings.contact_breaking_m,
            deterministicOverlappingPairs=1,
            physicsClientId=self._client,
        )
        bullet.setGravity(0, 0, -GRAVITY_M_S2, physicsClientId=self._client)
        # Without a visual of its own Bullet makes one from the shape, which takes longer than all the rest.
        self._visual = bullet.createVisualShape(
            bullet.GEOM_BOX, halfExtents=[0.001] * 3, physicsClientId=self._client
        )
        fixed = [*self._add_table(), self._add_object()]
        self._cup_id = self._add(self._shape_of(bodies.cup_file), _DRIVEN_MASS_KG)
        self._set_contact(self._cup_id, settings.cup_friction)
        for body_id in fixed:
            # The cup stands on the table before it is lifted; the arm carries it, whatever it touches.
            bullet.setCollisionFilterPair(self._cup_id, body_id, -1, -1, 0, physicsClientId=self._client)

    def __enter__(self) -> TableWorld:
        return self

    def __exit__(self, *exception: object) -> None:
        bullet.disconnect(physicsClientId=self._client)

    def add_candies(self, candies: Candies, T_base_cup: FloatArray, cup_quaternion: FloatArray) -> None:
        """Put the candies into the cup at `T_base_cup` (4, 4), whose rotation is `cup_quaternion` (4,)."""
        positions = transform_points(T_base_cup, candies.positions_m)
        for scale, position, quaternion in zip(candies.scales, positions, candies.quaternions, strict=True):
            _, turned = bullet.multiplyTransforms(
                [0, 0, 0], cup_quaternion.tolist(), [0, 0, 0], quaternion.tolist()
            )
            self._candies.append(self._add_candy(float(scale), position, turned))

    def add_lying(self, lying: LyingCandies) -> None:
        """Put candies where they lie in the object."""
        for scale, position, quaternion in zip(
            lying.scales, lying.positions_m, lying.quaternions, strict=True
        ):
            self._candies.append(self._add_candy(float(scale), position, tuple(quaternion.tolist())))

    def drive_cup(
        self,
        position_m: FloatArray,
        quaternion: FloatArray,
        velocity_m_s: FloatArray,
        angular_velocity_rad_s: FloatArray,
    ) -> None:
        """Place the cup (3,), (4,) for the next step, with the velocities (3,), (3,) that take it on."""
        cup, client = self._cup_id, self._client
        position = position_m.tolist()
        bullet.resetBasePositionAndOrientation(cup, position, quaternion.tolist(), physicsClientId=client)
        bullet.resetBaseVelocity(
            cup, velocity_m_s.tolist(), angular_velocity_rad_s.tolist(), physicsClientId=client
        )
        # Held against gravity, in every part of the step.
        lift_n = [0, 0, _DRIVEN_MASS_KG * GRAVITY_M_S2]
        bullet.applyExternalForce(cup, -1, lift_n, position, bullet.WORLD_FRAME, physicsClientId=client)

    def step(self) -> None:
        """Advance by one step, in as many parts as the candies' speed asks for."""
        if self._steps % _LOOK_STEPS == 0:
            self._choose_substeps()
        bullet.stepSimulation(physicsClientId=self._client)
        self._steps += 1

    def poses(self) -> FloatArray:
        """Return (N, 7) positions and quaternions of the candies."""
        return np.array(
            [
                [*position, *quaternion]
                for position, quaternion in (
                    bullet.getBasePositionAndOrientation(candy, physicsClientId=self._client)
                    for candy in self._candies
                )
            ]
        )

    def velocities_m_s(self) -> FloatArray:
        """Return (N, 3) velocities of the candies' centres."""
        return np.array(
            [bullet.getBaseVelocity(candy, physicsClientId=self._client)[0] for candy in self._candies]
        )

    def _choose_substeps(self) -> None:
        settings = self._settings
        positions, velocities = self.poses()[:, :3], self.velocities_m_s()
        near_cup, with_cup = self._cup_at(positions)
        low, high = self._bodies.aabb_m
        near_object = ((positions > low - _NEAR_M) & (positions < high + _NEAR_M)).all(axis=1)
        speeds = np.concatenate(
            [
                [0.0],
                np.linalg.norm(velocities[near_object], axis=1),
                np.linalg.norm((velocities - with_cup)[near_cup], axis=1),
            ]
        )
        parts = min(ceil(speeds.max() / (settings.safe_move_m * settings.rate_hz)), settings.max_substeps)
        if parts != self._substeps:
            self._substeps = parts
            # Bullet counts 0 as one part.
            bullet.setPhysicsEngineParameter(
                numSubSteps=parts if parts > 1 else 0, physicsClientId=self._client
            )

    def _cup_at(self, positions_m: FloatArray) -> tuple[BoolArray, FloatArray]:
        """Whether points (N, 3) are near the cup, and the velocity (N, 3) they have if they move with it."""
        client = self._client
        origin, quaternion = bullet.getBasePositionAndOrientation(self._cup_id, physicsClientId=client)
        linear, angular = bullet.getBaseVelocity(self._cup_id, physicsClientId=client)
        rotation = np.array(bullet.getMatrixFromQuaternion(quaternion)).reshape(3, 3)
        in_cup = transform_points(invert_pose(make_pose(rotation, origin)), positions_m)
        cup = self._bodies.cup
        near: BoolArray = (
            (np.hypot(in_cup[:, 0], in_cup[:, 1]) < cup.mouth_radius_m + _NEAR_M)
            & (in_cup[:, 2] > -_NEAR_M)
            & (in_cup[:, 2] < cup.length_m + _NEAR_M)
        )
        return near, np.array(linear) + np.cross(np.array(angular), positions_m - np.array(origin))

    def _add_table(self) -> list[int]:
        bodies, settings = self._bodies, self._settings
        plane = bullet.createCollisionShape(
            bullet.GEOM_PLANE, planeNormal=[0, 0, 1], physicsClientId=self._client
        )
        platform = bodies.platform
        low = np.array([*platform.min_m, bodies.table_height_m - _TABLE_DEPTH_M])
        high = np.array([*platform.max_m, platform.height_m])
        box = bullet.createCollisionShape(
            bullet.GEOM_BOX, halfExtents=((high - low) / 2).tolist(), physicsClientId=self._client
        )
        ids = [
            self._add(plane, 0.0, [0, 0, bodies.table_height_m]),
            self._add(box, 0.0, ((low + high) / 2).tolist()),
        ]
        for body_id in ids:
            self._set_contact(body_id, settings.table_friction)
        return ids

    def _add_object(self) -> int:
        body_id = self._add(self._shape_of(self._bodies.object_file), 0.0)
        self._set_contact(body_id, self._settings.object_friction)
        return body_id

    def _add_candy(self, scale: float, position_m: FloatArray, quaternion: tuple[float, ...]) -> int:
        settings = self._settings
        shape = bullet.createCollisionShape(
            bullet.GEOM_MESH, vertices=hull_m(settings, scale).tolist(), physicsClientId=self._client
        )
        mass_kg = settings.candy_mass_kg * scale**3
        body_id = self._add(shape, mass_kg, position_m.tolist(), quaternion)
        bullet.changeDynamics(
            body_id,
            -1,
            mass=mass_kg,
            collisionMargin=skin_m(settings, scale),
            localInertiaDiagonal=inertia_kg_m2(settings, scale).tolist(),
            lateralFriction=sqrt(settings.candy_friction),
            rollingFriction=0,
            spinningFriction=0,
            restitution=sqrt(settings.candy_restitution),
            physicsClientId=self._client,
        )
        return body_id

    def _set_contact(self, body_id: int, friction: float) -> None:
        """Give a wall what makes its contact with a candy as the settings say: Bullet multiplies the two."""
        settings = self._settings
        of_candy = sqrt(settings.candy_friction)
        # Rolling and spinning: one body's value times the other's sliding friction, added up both ways.
        arm = settings.rolling_arm_m / of_candy
        bullet.changeDynamics(
            body_id,
            -1,
            lateralFriction=friction / of_candy,
            rollingFriction=arm,
            spinningFriction=arm,
            restitution=settings.wall_restitution / sqrt(settings.candy_restitution),
            physicsClientId=self._client,
        )

    def _shape_of(self, body: BodyFile) -> int:
        shape: int = bullet.createCollisionShape(
            bullet.GEOM_MESH,
            fileName=body.path,
            flags=bullet.GEOM_FORCE_CONCAVE_TRIMESH if body.is_concave else 0,
            physicsClientId=self._client,
        )
        return shape

    def _add(
        self,
        shape: int,
        mass_kg: float,
        position_m: list[float] | None = None,
        quaternion: tuple[float, ...] = (0.0, 0.0, 0.0, 1.0),
    ) -> int:
        body_id: int = bullet.createMultiBody(
            mass_kg,
            shape,
            self._visual,
            basePosition=position_m or [0.0, 0.0, 0.0],
            baseOrientation=quaternion,
            useMaximalCoordinates=1,
            physicsClientId=self._client,
        )
        bullet.changeDynamics(
            body_id,
            -1,
            linearDamping=0,
            angularDamping=0,
            activationState=bullet.ACTIVATION_STATE_DISABLE_SLEEPING,
            physicsClientId=self._client,
        )
        return body_id
