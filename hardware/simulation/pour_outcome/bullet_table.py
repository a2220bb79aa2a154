"""The simulated table in Bullet: object, platform and table at rest, the driven cup, and the candies.

It is the ground-truth simulation, a world of its own, not the imagination's: none of the settings is shared,
and each is given explicitly.
What was measured for that one holds here too (docs/decisions/0001 and 0002): a driven body is a very heavy
dynamic one that is placed before each step, and candies that are fast near walls get finer steps.
"""

from __future__ import annotations

from math import ceil, sqrt

import numpy as np

from core.errors import WorkerError
from core.geometry import BoolArray, FloatArray, invert_pose, make_pose, transform_points
from core.imagination.body import BodyFile, body_files
from core.imagination.cup import cup_parts
from core.imagination.engine import bullet
from hardware.simulation.pour_outcome.bodies import GRAVITY_M_S2, Bodies
from hardware.simulation.pour_outcome.candies import Candies, hull_m, inertia_kg_m2, skin_m
from hardware.simulation.pour_outcome.settings import OutcomeSettings

_DRIVEN_MASS_KG = 1e4
_CHECK_STEPS = 4
"""Steps between two checks of how fast the candies are."""
_NEAR_M = 0.02
"""From the walls of cup or object: this far away a candy may be fast."""
_CUP_SKIN_M = 0.001
"""Bullet lays a skin as thick as this around the parts of the cup."""


class BulletTable:
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
        mesh, cup = bodies.object, bodies.cup
        # Its skin makes walls thicker: this much further out, the cup is as wide inside as it should be.
        wider = cup.model_copy(update={"mouth_radius_m": cup.mouth_radius_m + _CUP_SKIN_M})
        with body_files(object=([mesh], True), cup=(cup_parts(wider), False)) as files:
            fixed = [*self._add_table(), self._add_object(files["object"])]
            self._cup_id = self._add(self._shape_of(files["cup"]), _DRIVEN_MASS_KG)
        self._set_contact(self._cup_id, settings.cup_friction)
        for body_id in fixed:
            # The cup stands on the table before it is lifted; the arm carries it, whatever it touches.
            bullet.setCollisionFilterPair(self._cup_id, body_id, -1, -1, 0, physicsClientId=self._client)

    def __enter__(self) -> BulletTable:
        return self

    def __exit__(self, *exception: object) -> None:
        bullet.disconnect(physicsClientId=self._client)

    def add_candies(self, candies: Candies) -> None:
        """Put candies where they are in the base frame; all of them before the first step."""
        for scale, position, quaternion in zip(
            candies.scales, candies.positions_m, candies.quaternions, strict=True
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
        if self._steps % _CHECK_STEPS == 0:
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
        mesh = self._bodies.object
        low, high = mesh.aabb_min_m, mesh.aabb_max_m
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
        low, high = bodies.platform_box_m
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

    def _add_object(self, file: BodyFile) -> int:
        body_id = self._add(self._shape_of(file), 0.0)
        self._set_contact(body_id, self._settings.object_friction)
        return body_id

    def _add_candy(self, scale: float, position_m: FloatArray, quaternion: tuple[float, ...]) -> int:
        settings = self._settings
        shape = self._candy_shape(scale)
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

    def _candy_shape(self, scale: float) -> int:
        settings = self._settings
        if settings.candy_shape == "ball":
            geometry = {"shapeType": bullet.GEOM_SPHERE, "radius": scale * settings.candy_diameter_m / 2}
        else:
            geometry = {"shapeType": bullet.GEOM_MESH, "vertices": hull_m(settings, scale).tolist()}
        shape: int = bullet.createCollisionShape(**geometry, physicsClientId=self._client)
        return shape

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
