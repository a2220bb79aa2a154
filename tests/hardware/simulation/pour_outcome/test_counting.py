import numpy as np
import pytest

from core.geometry import transform_points
from core.mesh import TriangleMesh
from core.mesh_topology import join
from hardware.simulation.families.forms import slab
from hardware.simulation.objects import builtin_object
from hardware.simulation.pour_outcome.counting import in_object
from hardware.simulation.pour_outcome.playing import inside_cup
from tests.hardware.simulation.pour_outcome.paths import CUP, UPRIGHT_RAD, turned


def counted(mesh: TriangleMesh, *point_m: float, margin_m: float = 0.015) -> bool:
    return bool(in_object(mesh, np.array([point_m]), 0.0, margin_m, (0.0132, 0.007))[0])


@pytest.mark.parametrize(
    ("point_m", "is_in"),
    [
        ((0.013, 0.007, 0.0105), True),  # on the floor
        ((0.013, 0.007, 0.075), True),  # on a heap
        ((0.013, 0.007, 0.09), False),  # flying
        ((0.07, 0.07, 0.0035), False),  # on the platform, in a corner of the AABB
        ((0.066, 0.003, 0.0035), False),  # on the platform, below the rim that leans out
        ((0.09, 0.0, 0.0035), False),  # beside
        ((0.0, 0.0, -0.01), False),  # on the table
    ],
)
def test_in_the_bowl_is_what_it_carries(point_m: tuple[float, float, float], is_in: bool) -> None:
    assert counted(builtin_object("bowl"), *point_m) is is_in


def test_a_ring_holds_nothing() -> None:
    assert not counted(builtin_object("ring"), 0.001, 0.002, 0.0035)


def test_a_crack_narrower_than_a_candy_spills_nothing() -> None:
    def floor_with_gap(gap_m: float) -> TriangleMesh:
        left, right = [[-0.05, -gap_m / 2], [gap_m / 2, 0.05]]
        corners = [
            (x, y, 0.002) for a, b in (left, right) for x, y in ((a, -0.05), (b, -0.05), (b, 0.05), (a, 0.05))
        ]
        wall = [(-0.05, -0.05, 0.0), (-0.05, 0.05, 0.0), (-0.05, 0.0, 0.04)]
        faces = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7], [8, 9, 10]])
        return TriangleMesh(np.array([*corners, *wall]), faces)

    assert counted(floor_with_gap(0.006), 0.0, 0.001, 0.006)
    assert not counted(floor_with_gap(0.02), 0.0, 0.001, 0.006)


@pytest.mark.parametrize(
    ("opening_m", "is_in"), [(0.002, True), (0.0042, True), (0.0076, True), (0.016, False), (0.02, False)]
)
def test_on_a_grid_lies_what_cannot_fall_through(opening_m: float, is_in: bool) -> None:
    """Bars of 2 mm, most of it open; wherever in the grid the candy lies."""
    bar_m, n = 0.002, 12
    pitch_m = opening_m + bar_m
    length_m, places_m = 2 * n * pitch_m, pitch_m * np.arange(-n, n + 1)
    along_x = [slab((length_m, bar_m, bar_m), (0, place, 0.01)) for place in places_m]
    along_y = [slab((bar_m, length_m, bar_m), (place, 0, 0.01)) for place in places_m]
    grid = join(tuple(along_x + along_y))
    for at in np.linspace(0.0, 1.0, 5):
        over_m = (0.5 if opening_m > 0.0132 else at) * pitch_m
        assert counted(grid, over_m, over_m / 2 + pitch_m / 4, 0.0155) is is_in


def test_heaps_count_up_to_the_margin() -> None:
    box = builtin_object("box")
    assert counted(box, 0.01, 0.01, 0.105, margin_m=0.02)
    assert not counted(box, 0.01, 0.01, 0.105, margin_m=0.01)


def test_in_the_cup_is_what_lies_within_its_walls() -> None:
    T = turned(np.array([0.1, 0.2, 0.3]), 0.7, np.array([UPRIGHT_RAD + 0.4]))[0]
    points = np.array([[0, 0, 0.01], [0.0, 0.02, 0.1], [0.0, 0.04, 0.05], [0, 0, 0.12], [0, 0, -0.01]])
    assert inside_cup(CUP, T, transform_points(T, points)).tolist() == [True, True, False, False, False]
