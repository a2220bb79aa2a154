"""The whole scan of Sec. IV-A without a robot: an object on the platform, seen from all views."""

from __future__ import annotations

import numpy as np

from core.errors import InputError
from core.geometry import FloatArray, make_pose, rotation_z, transform_points
from core.mesh import TriangleMesh
from core.parameters.reconstruction import ReconstructionParameters
from core.progress import Reporter
from core.scan.crop_box import crop_box_of
from core.scan.model import RgbdFrame, Scan
from hardware.simulation.depth_camera import SimulatedDepthCamera
from hardware.simulation.depth_noise import DepthNoise, disturb_pose
from hardware.simulation.scan_views import scan_views
from hardware.simulation.world import World

STAGE = "scan"
PLATFORM_ABOVE_BOX_M = 0.05
"""The platform's top above the crop box's floor: room for the truncation of the fusion below the object."""
PLATFORM_ABOVE_TABLE_M = 0.065
LOOK_ABOVE_PLATFORM_M = 0.06
WALL_MARGIN_M = 0.01
"""Room kept between object and crop box."""
MAX_OFFSET_M = 0.03
_PLACING_DRAWS = 200


def simulate_scan(
    mesh: TriangleMesh,
    seed: int,
    reporter: Reporter,
    parameters: ReconstructionParameters | None = None,
    noise: DepthNoise | None = DepthNoise(),  # noqa: B008  (frozen)
) -> Scan:
    """Put an object on the platform at random and take the 24 views; 2 s.

    The images are taken from disturbed poses, the frames carry the undisturbed ones: that is the pose error.
    Each view has its own random stream, so one can be taken again without the others.

    Args:
        mesh: the object in metres, z up; where its frame lies does not matter.
        seed: of the placing, the pose errors and the images.
        reporter: told after each view.
        parameters: of the reconstruction; their crop box holds the object and the views look at its middle.
        noise: `None` for a perfect camera at exactly known poses.

    Raises:
        InputError: the object does not fit into the crop box.
        Cancelled: somebody asked to stop.
    """
    parameters = parameters or ReconstructionParameters()
    placed = transform_mesh(mesh, place_on_platform(mesh, seed, parameters))
    target = _platform_center(parameters)
    camera = SimulatedDepthCamera(World(placed, target - np.array([0, 0, PLATFORM_ABOVE_TABLE_M])), noise)
    views = scan_views(target + np.array([0, 0, LOOK_ABOVE_PLATFORM_M]))
    frames = []
    for k, T_base_camera in enumerate(views):
        reporter.raise_if_cancelled()
        random = np.random.default_rng([seed, 1 + k])
        T_true = T_base_camera if noise is None else disturb_pose(T_base_camera, noise, random)
        color, depth = camera.capture(T_true, random)
        frames.append(RgbdFrame(f"frame-{k:06d}", color, depth, T_base_camera))
        reporter.progress(STAGE, k + 1, len(views))
    return Scan(tuple(frames), camera.intrinsics, float(target[2]), crop_box_of(None, parameters))


def place_on_platform(mesh: TriangleMesh, seed: int, parameters: ReconstructionParameters) -> FloatArray:
    """Return `T_base_object` of an object upright on the platform: any yaw, up to 30 mm beside its middle.

    Raises:
        InputError: the object does not fit into the crop box, however it is turned.
    """
    random = np.random.default_rng([seed, 0])
    box = crop_box_of(None, parameters)
    low, high = np.array(box.min_m) + WALL_MARGIN_M, np.array(box.max_m) - WALL_MARGIN_M
    center = _platform_center(parameters)
    for _ in range(_PLACING_DRAWS):
        rotation = rotation_z(random.uniform(0, 2 * np.pi))
        offset = random.uniform(-MAX_OFFSET_M, MAX_OFFSET_M, size=2)
        turned = mesh.vertices_m @ rotation.T
        middle = (turned.min(axis=0) + turned.max(axis=0)) / 2
        stand = center + np.array([*(offset - middle[:2]), -turned[:, 2].min()])
        if (turned.min(axis=0) + stand >= low).all() and (turned.max(axis=0) + stand <= high).all():
            return make_pose(rotation, stand)
    size = " x ".join(f"{edge * 1000:.0f}" for edge in mesh.extents_m)
    room = " x ".join(f"{edge * 1000:.0f}" for edge in (*(high - low)[:2], high[2] - center[2]))
    raise InputError(
        f"The object of {size} mm does not fit on the platform, whose crop box has room for {room} mm; "
        "take a smaller object, or enlarge reconstruction.crop_min_m and crop_max_m."
    )


def transform_mesh(mesh: TriangleMesh, T_target_source: FloatArray) -> TriangleMesh:
    """Return the mesh in another frame."""
    return TriangleMesh(transform_points(T_target_source, mesh.vertices_m), mesh.faces)


def _platform_center(parameters: ReconstructionParameters) -> FloatArray:
    """Middle (3,) of the platform's top, in the base frame."""
    box = crop_box_of(None, parameters)
    low, high = np.array(box.min_m), np.array(box.max_m)
    return np.array([*(low + high)[:2] / 2, low[2] + PLATFORM_ABOVE_BOX_M])
