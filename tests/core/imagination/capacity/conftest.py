import numpy as np
import pytest

from core.mesh import TriangleMesh
from core.mesh_topology import join
from core.parameters import Parameters, apply_settings
from core.parameters.imagination import CapacityParameters
from tests.core.imagination.conftest import box


def turned(profile_m: list[tuple[float, float]], sides: int = 64) -> TriangleMesh:
    """A body turned about z, its outline (r, z) from the axis up the outside and down the inside."""
    angles = np.arange(sides) * 2 * np.pi / sides
    vertices = np.array([(r * np.cos(a), r * np.sin(a), z) for r, z in profile_m for a in angles])
    faces = []
    for ring in range(len(profile_m) - 1):
        for k in range(sides):
            a, b = ring * sides + k, ring * sides + (k + 1) % sides
            faces += [[a, b, b + sides], [a, b + sides, a + sides]]
    return TriangleMesh(vertices, np.array(faces))


def polygon_share(sides: int = 64) -> float:
    """Area of a regular polygon over that of its circle."""
    return sides / (2 * np.pi) * np.sin(2 * np.pi / sides)


def open_box(inner_m, wall_m: float, notch_m: tuple[float, float] | None = None) -> TriangleMesh:
    """An open box of thick walls; a notch (width, depth) from the rim down in the middle of one of them."""
    x, y, z = inner_m
    w, top = wall_m, wall_m + z
    parts = [
        box((-w, -w, 0), (x + w, y + w, w)),
        box((-w, -w, 0), (0, y + w, top)),
        box((-w, -w, 0), (x + w, 0, top)),
        box((-w, y, 0), (x + w, y + w, top)),
    ]
    width, depth = notch_m or (0.0, 0.0)
    low, high = (y - width) / 2, (y + width) / 2
    parts += [
        box((x, -w, 0), (x + w, low, top)),
        box((x, high, 0), (x + w, y + w, top)),
    ]
    if notch_m:
        parts.append(box((x, low, 0), (x + w, high, top - depth)))
    return join(tuple(parts))


@pytest.fixture(scope="session")
def candies() -> Parameters:
    """The candy and the perturbation, given explicitly."""
    return apply_settings(
        Parameters(),
        {
            "seed": 3,
            "particle.shape": "ellipsoid",
            "particle.diameter_m": 0.0132,
            "particle.height_m": 0.007,
            "particle.mass_kg": 0.0009,
            "solver.rate_hz": 240,
            "solver.substeps": 10,
            "solver.iterations": 20,
            "containability.n_max": 80,
            "containability.rotation_rad": 0.26,
            "containability.rotation_s": 2.5,
            "containability.counted": "centre",
            "containability.contact.lateral_friction": 0.2,
            "containability.contact.rolling_friction": 0.02,
            "containability.contact.spinning_friction": 0.02,
        },
    )


@pytest.fixture(scope="session")
def few() -> CapacityParameters:
    return CapacityParameters(
        n_fillings=2, n_aimed=40, n_real=30, widths_in_mouth=2.5, rain_m_s=0.4, lattice_points=200_000
    )
