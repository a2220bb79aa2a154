import numpy as np
import pytest

from core.geometry import transform_points
from core.mesh import TriangleMesh
from hardware.simulation.objects import builtin_object
from hardware.simulation.pour_outcome.outcome import in_object
from hardware.simulation.pour_outcome.playing import inside_cup
from tests.hardware.simulation.pour_outcome.paths import CUP, UPRIGHT_RAD, turned


def counted(mesh: TriangleMesh, *point_m: float, margin_m: float = 0.015) -> bool:
    return bool(in_object(mesh, np.array([point_m]), 0.0, margin_m, 0.0066)[0])


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


def test_heaps_count_up_to_the_margin() -> None:
    box = builtin_object("box")
    assert counted(box, 0.01, 0.01, 0.105, margin_m=0.02)
    assert not counted(box, 0.01, 0.01, 0.105, margin_m=0.01)


def test_in_the_cup_is_what_lies_within_its_walls() -> None:
    T = turned(np.array([0.1, 0.2, 0.3]), 0.7, np.array([UPRIGHT_RAD + 0.4]))[0]
    points = np.array([[0, 0, 0.01], [0.0, 0.02, 0.1], [0.0, 0.04, 0.05], [0, 0, 0.12], [0, 0, -0.01]])
    assert inside_cup(CUP, T, transform_points(T, points)).tolist() == [True, True, False, False, False]
