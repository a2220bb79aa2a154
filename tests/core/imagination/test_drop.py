import numpy as np
import pytest
import trimesh

from core.collision import CollisionModel, from_parts
from core.imagination.drop import imagine_drop
from core.mesh import TriangleMesh
from core.mesh_topology import join
from core.parameters import Parameters, apply_settings
from tests.core.imagination.conftest import box
from tests.core.imagination.here import here


def wide_tray(width_m: float, wall_m: float, height_m: float):
    """An open square tray, its walls and its floor as thick as `wall_m`."""
    inner = width_m - wall_m
    return from_parts(
        (
            box((0, 0, 0), (width_m, width_m, wall_m)),
            box((0, 0, 0), (wall_m, width_m, height_m)),
            box((inner, 0, 0), (width_m, width_m, height_m)),
            box((0, 0, 0), (width_m, wall_m, height_m)),
            box((0, inner, 0), (width_m, width_m, height_m)),
        )
    )


@pytest.mark.parametrize("tilt_deg", [3, 15])
def test_a_wide_tray_keeps_its_candies_however_far_its_corners_sink(tilt_deg):
    """Turned by 15 degrees a corner sinks by 40 mm: what lies in it has not fallen out."""
    settings = {
        "containability.n_max": 60,
        "containability.n_min": 10,
        "containability.rotation_rad": np.radians(tilt_deg),
        "particle.shape": "sphere",
        "particle.diameter_m": 0.01,
    }
    found = imagine_drop(here(apply_settings(Parameters(), settings)), wide_tray(0.3, 0.01, 0.12))
    above_inside = ((found.drop_positions_m[:, :2] > 0.01) & (found.drop_positions_m[:, :2] < 0.29)).all(
        axis=1
    )
    assert above_inside.sum() == 25
    assert found.retained[above_inside].all()


@pytest.mark.parametrize(("height_m", "is_counted"), [(0.014, False), (0.030, True)])
def test_a_hollow_that_one_layer_fills_keeps_candies_but_counts_none(height_m, is_counted):
    """The rim is 9 mm high, more than a candy but less than one and a half; or it is 25 mm high."""
    settings = {"containability.n_max": 60, "containability.n_min": 10, "containability.rotation_rad": 0.0}
    tray = wide_tray(0.2, 0.005, height_m)

    def omega(counted: str) -> float:
        chosen = {**settings, "containability.counted": counted}
        return imagine_drop(here(apply_settings(Parameters(), chosen)), tray).omega

    assert omega("centre") > 0.5
    assert (omega("room_above") > 0.5) is is_counted


@pytest.mark.parametrize(
    ("width_m", "n_drops"), [pytest.param(0.032, 6, marks=pytest.mark.system), (0.039, 1), (0.045, 1)]
)
def test_candies_find_into_a_small_round_cup(width_m, n_drops):
    """Its side has room for two candies: dropped at the edges of its box all of them would fall beside it.

    In the smallest the middle is that of six drops: the 10 to 14 candies that one drop leaves there lie
    1 to 4 mm aside, and which ones stay differs between processors.
    """
    outer_m, floor_m, height_m = width_m / 2, 0.002, 0.036
    wall = trimesh.creation.annulus(outer_m - 0.0015, outer_m, height_m, sections=48)
    bottom = trimesh.creation.cylinder(outer_m, floor_m, sections=48)
    bottom.apply_translation([0, 0, (floor_m - height_m) / 2])
    cup = join([TriangleMesh(np.array(one.vertices), np.array(one.faces)) for one in (wall, bottom)])
    model = CollisionModel.exact(cup)
    found = [
        imagine_drop(here(apply_settings(Parameters(), {"seed": seed})), model) for seed in range(n_drops)
    ]
    assert min(one.retained.sum() for one in found) >= 5
    middle_m = np.mean([one.footprint.center_m[:2] for one in found], axis=0)
    assert np.hypot(*middle_m) < 0.003
