"""Parameters from the depth images to the collision model (Sec. IV-A, IV-C)."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from core.parameters.fields import CODE, OURS, PAPER, Group, choice, quantity

Coordinate = Annotated[float, Field(ge=-10, le=10)]
Point = tuple[Coordinate, Coordinate, Coordinate]


class ReconstructionParameters(Group):
    """TSDF fusion and segmentation of the object, in the robot's base frame."""

    voxel_m: float = quantity(
        0.002, "Edge of a voxel.", unit="m", source=f"{OURS}; {CODE}: 0.004", low=0.001, high=0.02
    )
    fine_voxel_m: float = quantity(
        0.0015,
        "Edge of a voxel of an object whose box holds less than 5 litres, where finer: walls may be thin.",
        unit="m",
        source=f"{OURS}: docs/decisions/0053",
        low=0.001,
        high=0.02,
    )
    truncation_m: float | None = quantity(
        None,
        "Distance at which the signed distance is cut off; none: it follows the measured pose error.",
        unit="m",
        source=f"{OURS}; {CODE}: five voxels",
        low=0.002,
        high=0.1,
    )
    crop_min_m: Point | None = quantity(
        None,
        "Lower corner of the box that holds the object; none: the scan's own, or else the released code's "
        "grid from (-0.30, -0.55, 0.03) to (0.18, -0.15, 0.35).",
        unit="m",
        source=f"{OURS}; {CODE}: its grid",
    )
    crop_max_m: Point | None = quantity(
        None, "Upper corner of that box; given or left out with the lower one.", unit="m", source=OURS
    )
    unseen: Literal["solid", "free"] = choice(
        "solid",
        "What a voxel is that no view saw: solid above the platform, or free everywhere.",
        source=f"{OURS}; {CODE}: free",
    )
    platform_height_m: float | None = quantity(
        None,
        "Height of the transparent platform's top; none: the scan's own, or else estimated from the images.",
        unit="m",
        source=OURS,
        low=-2,
        high=2,
    )
    segmentation: Literal["box", "plane"] = choice(
        "box",
        "How the object is told from the scene: the crop box alone (transparent platform), or with the "
        "supporting plane found and removed (RANSAC).",
        source=f"{PAPER}, Sec. IV-A and its footnote",
    )
    plane_margin_m: float = quantity(
        0.006,
        "With plane segmentation: what is removed above the plane.",
        unit="m",
        source=OURS,
        low=0,
        high=0.05,
    )
    refine_poses: bool = choice(
        True,
        "Whether the views' poses are corrected until the surfaces they show agree.",
        source=f"{OURS}; {CODE}: no",
    )
    max_depth_m: float = quantity(
        6.0, "Depth beyond which a pixel is ignored.", unit="m", source=CODE, low=0.1, high=20
    )

    @model_validator(mode="after")
    def _box_has_volume(self) -> ReconstructionParameters:
        if self.crop_min_m is None and self.crop_max_m is None:
            return self
        if self.crop_min_m is None or self.crop_max_m is None:
            raise ValueError("crop_min_m and crop_max_m are given both or not at all")
        if any(high - low < 0.01 for low, high in zip(self.crop_min_m, self.crop_max_m, strict=True)):
            raise ValueError("crop_max_m must exceed crop_min_m by at least 0.01 m in every direction")
        return self


class CollisionParameters(Group):
    """How the reconstructed surface becomes a body for the physics (Sec. IV-C)."""

    method: Literal["exact", "vhacd", "coacd"] = choice(
        "exact",
        "The surface itself (exact), or convex parts by V-HACD (the paper's) or CoACD.",
        source=f"{OURS}; {PAPER}: V-HACD",
    )
    aabb_margin_m: float = quantity(
        0.0,
        "Added on every side of the object's AABB, as Bullet pads it.",
        unit="m",
        source=f"{PAPER}: none; {CODE}: 0.003, measured",
        low=0,
        high=0.02,
    )
    max_faces: int = quantity(
        4_000,
        "Faces above which the mesh is simplified first; thin walls may keep four times as many.",
        unit="",
        source=OURS,
        low=100,
        high=200_000,
    )
    vhacd_voxels: int = quantity(50_000, "Voxels of V-HACD.", unit="", source=OURS, low=1_000, high=2_000_000)
    vhacd_hulls: int = quantity(32, "Most convex parts of V-HACD.", unit="", source=OURS, low=1, high=512)
    coacd_threshold: float = quantity(
        0.05,
        "Concavity that CoACD leaves, relative to the size of the object.",
        unit="",
        source=OURS,
        low=0.01,
        high=1,
    )
