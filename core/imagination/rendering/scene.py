"""A scene for pictures only: visual shapes in one Bullet server, nothing collides, nothing is stepped.

EGL clients in one process share their state, and a picture taken from a second thread crashes (bullet3 issues
3318, 4477): use one scene at a time, in a worker's main thread.
"""

from __future__ import annotations

import importlib.util
import tempfile
from pathlib import Path

import numpy as np
import numpy.typing as npt

from core.errors import StageError
from core.geometry import AnyArray, FloatArray
from core.imagination.engine import bullet
from core.imagination.recording import Float32Array
from core.imagination.rendering.camera import Camera, light_direction, view_direction
from core.imagination.rendering.shapes import candy_mesh, write_ground_obj, write_obj
from core.imagination.rotations import quaternion_of
from core.mesh import TriangleMesh
from core.parameters.bodies import ParticleParameters
from core.quiet import quiet

EGL, TINY = "EGL", "TinyRenderer"

Picture = npt.NDArray[np.uint8]
Color = tuple[float, float, float, float]

OBJECT_COLOR: Color = (0.88, 0.84, 0.78, 1.0)
CUP_COLOR: Color = (0.35, 0.55, 0.60, 0.35)
GROUND_COLOR: Color = (0.95, 0.95, 0.94, 1.0)
KEPT_COLOR: Color = (0.00, 0.40, 0.82, 1.0)
LOST_COLOR: Color = (0.95, 0.45, 0.00, 1.0)
"""Blue and orange stay apart for colour-blind eyes (Okabe & Ito 2008)."""

# Bullet's shadow map spans some metres whatever is in it: the scene is enlarged to fill it.
_SCENE_UNITS = 4.0
_SMALLEST_M = 0.15
_GROUND_UNITS = 60.0
_LAMP_UNITS = 40.0
_HIDDEN_UNITS = (0.0, 0.0, -500.0)
# The OpenGL shader keeps at least half the light everywhere; this exponent gives the picture its depth back.
_EGL_GAMMA = 1.7
# Nothing is lighter than the lit ground, so the shader's glare leaves no spot on it.
_LIGHTEST = 243
_GAMMA_TABLE = np.minimum(255 * (np.arange(256) / 255) ** _EGL_GAMMA, _LIGHTEST).astype(np.uint8)


class Scene:
    """A lit ground, meshes and candies of two colours, as a context manager."""

    def __init__(self, folder: Path, aabb_m: FloatArray, with_egl: bool) -> None:
        """Open a scene around an object with the AABB `aabb_m` (2, 3); `forward` is its line of sight.

        `folder` takes the files Bullet reads; they are removed when the scene closes.

        Raises:
            StageError: Bullet started no server.
        """
        extents_m = aabb_m[1] - aabb_m[0]
        self.forward = view_direction(extents_m)
        self._lamp = light_direction(self.forward)
        self._center_m = aabb_m.mean(axis=0)
        self._scale = _SCENE_UNITS / max(float(np.linalg.norm(extents_m)), _SMALLEST_M)
        self._candies: dict[bool, list[int]] = {False: [], True: []}
        self._cup: int | None = None
        self._client = bullet.connect(bullet.DIRECT)
        if self._client < 0:
            raise StageError(
                "Bullet started no server for the pictures; close other simulations and try again."
            )
        self._n_files = 0
        self._is_warm = False
        self._files = tempfile.TemporaryDirectory(dir=folder)
        self.renderer = EGL if with_egl and load_egl(self._client) else TINY

    def __enter__(self) -> Scene:
        return self

    def __exit__(self, *exception: object) -> None:
        bullet.disconnect(self._client)
        self._files.cleanup()

    def add_ground(self, height_m: float) -> None:
        """Add a wide ground that takes shadows."""
        path = self._new_file()
        center = np.array([*self._center_m[:2], height_m])
        # Facing the lamp it is evenly light; its true normal would mirror the lamp into the picture.
        write_ground_obj(path, center, _GROUND_UNITS / self._scale, self._lamp, self._scale)
        self.move_mesh(self._add_body(self._add_shape(path, GROUND_COLOR)), np.eye(4))

    def add_mesh(self, mesh: TriangleMesh, color: Color) -> int:
        """Add a surface at the pose identity and return its id."""
        body_id = self._add_body(self._add_shape(self._written(mesh), color))
        self.move_mesh(body_id, np.eye(4))
        return body_id

    def add_cup(self, mesh: TriangleMesh) -> int:
        """Add a surface through which the candies are seen (see `cup_surface`), and return its id."""
        self._cup = self.add_mesh(mesh, CUP_COLOR)
        return self._cup

    def add_candies(self, particle: ParticleParameters, n_kept: int, n_lost: int) -> None:
        """Add as many candies of each colour as are ever shown at once."""
        path = self._written(candy_mesh(particle))
        for is_kept, color, n in ((True, KEPT_COLOR, n_kept), (False, LOST_COLOR, n_lost)):
            if n:
                shape = self._add_shape(path, color)
                self._candies[is_kept] = [self._add_body(shape) for _ in range(n)]

    def move_mesh(self, body_id: int, T_world_body: AnyArray) -> None:
        """Place a mesh at a pose (4, 4)."""
        position = self._units(T_world_body[:3, 3])
        quaternion = quaternion_of(T_world_body[:3, :3].astype(float))
        self._place(body_id, position, quaternion.tolist())

    def move_candies(
        self, positions_m: Float32Array, quaternions: Float32Array, retained: npt.NDArray[np.bool_]
    ) -> None:
        """Show candies at (N, 3) and (N, 4), coloured by whether they are kept; NaN hides one."""
        is_there = np.isfinite(positions_m[:, 2])
        for is_kept, body_ids in self._candies.items():
            shown = np.flatnonzero(is_there & (retained == is_kept))
            positions = self._units(positions_m[shown])
            for body_id, position, quaternion in zip(
                body_ids, positions, quaternions[shown].tolist(), strict=False
            ):
                self._place(body_id, position, quaternion)
            for body_id in body_ids[len(shown) :]:
                self._place(body_id, _HIDDEN_UNITS, (0, 0, 0, 1))

    def photograph(self, camera: Camera, width: int, height: int) -> Picture:
        """Take a picture (height, width, 3), RGB."""
        if not self._is_warm:
            # The first two pictures of an EGL client lack their shadows.
            for _ in range(2 if self.renderer == EGL else 0):
                self._shoot(camera, 16, 16)
            self._is_warm = True
        if self.renderer == EGL or self._cup is None:
            return self._shoot(camera, width, height)
        return self._shoot_through_cup(camera, width, height)

    def _shoot_through_cup(self, camera: Camera, width: int, height: int) -> Picture:
        """TinyRenderer knows no transparency: mix the picture with the cup into the one without."""
        assert self._cup is not None
        with_cup = self._shoot(camera, width, height).astype(np.float32)
        position, quaternion = bullet.getBasePositionAndOrientation(self._cup, physicsClientId=self._client)
        self._place(self._cup, _HIDDEN_UNITS, quaternion)
        without = self._shoot(camera, width, height).astype(np.float32)
        self._place(self._cup, position, quaternion)
        mixed: Picture = (CUP_COLOR[3] * with_cup + (1 - CUP_COLOR[3]) * without).astype(np.uint8)
        return mixed

    def _shoot(self, camera: Camera, width: int, height: int) -> Picture:
        eye = np.array(self._units(camera.eye_m))
        view = bullet.computeViewMatrix(eye.tolist(), (eye + camera.forward).tolist(), (0, 0, 1))
        reach = camera.reach_m * self._scale
        projection = bullet.computeProjectionMatrixFOV(
            camera.field_of_view_deg, camera.aspect, reach / 50, reach * 20
        )
        answer = bullet.getCameraImage(
            width,
            height,
            view,
            projection,
            lightDirection=(_LAMP_UNITS * self._lamp).tolist(),
            lightDistance=_LAMP_UNITS,
            lightAmbientCoeff=0.55,
            lightDiffuseCoeff=0.5,
            lightSpecularCoeff=0.05,
            shadow=int(self.renderer == EGL),
            renderer=bullet.ER_BULLET_HARDWARE_OPENGL if self.renderer == EGL else bullet.ER_TINY_RENDERER,
            flags=bullet.ER_NO_SEGMENTATION_MASK,
            physicsClientId=self._client,
        )
        picture = np.asarray(answer[2], dtype=np.uint8).reshape(height, width, 4)[..., :3]
        return _GAMMA_TABLE[picture] if self.renderer == EGL else picture.copy()

    def _new_file(self) -> Path:
        self._n_files += 1
        return Path(self._files.name) / f"{self._n_files}.obj"

    def _written(self, mesh: TriangleMesh) -> Path:
        path = self._new_file()
        write_obj(path, mesh, self._scale)
        return path

    def _add_shape(self, path: Path, color: Color) -> int:
        shown = color if self.renderer == TINY else (*(c ** (1 / _EGL_GAMMA) for c in color[:3]), color[3])
        shape: int = bullet.createVisualShape(
            bullet.GEOM_MESH,
            fileName=str(path),
            rgbaColor=shown,
            specularColor=(0.1, 0.1, 0.1),
            physicsClientId=self._client,
        )
        return shape

    def _add_body(self, shape: int) -> int:
        body_id: int = bullet.createMultiBody(
            0, baseVisualShapeIndex=shape, basePosition=_HIDDEN_UNITS, physicsClientId=self._client
        )
        return body_id

    def _place(self, body_id: int, position: object, quaternion: object) -> None:
        bullet.resetBasePositionAndOrientation(body_id, position, quaternion, physicsClientId=self._client)

    def _units(self, points_m: AnyArray) -> list[float]:
        units: list[float] = ((points_m.astype(float) - self._center_m) * self._scale).tolist()
        return units


def load_egl(client: int) -> bool:
    """Load Bullet's EGL plugin into a client and return whether it is there.

    With a broken graphics driver this may end the process: call it in a worker.
    """
    plugin = importlib.util.find_spec("eglRenderer")
    if plugin is None or plugin.origin is None:
        return False
    with quiet(2):
        loaded: int = bullet.loadPlugin(plugin.origin, "_eglRendererPlugin", physicsClientId=client)
    return loaded >= 0
