"""Choose the simulated cell's scan views for a UR5 and print them for a TOML file (decision 0006), in a
minute.

Usage: python -m tests.benchmarks.choose_views > scan_views.toml
Figures go to stderr: per elevation what can be reached, and how well the dome is covered.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

import numpy as np

from core.geometry import FloatArray
from core.motion.clearance import MotionScene
from core.motion.joint_path import check_path, path_length
from core.motion.view_tour import Stop, ViewNet, plan_tour
from core.motion.views import ReachableView, choose_spread_views, coverage, reachable_views
from tests.core.motion.cell import HOME_RAD, T_FLANGE_CAMERA, TASK, simulated_cell
from tests.ideal_rings import scan_views

N_VIEWS = 24


def main() -> None:
    """Choose, print the rows and the figures."""
    scene = simulated_cell()
    views = reachable_views(scene, TASK)
    net = ViewNet(scene, views, HOME_RAD, TASK.min_clearance_m)
    stops = plan_tour(net, choose_spread_views(net.views, N_VIEWS))
    _print_rows(scene, stops)
    _report("reachable", views)
    _report("and from home", net.views)
    _report("chosen", [stop.view for stop in stops])
    _report_missing(net.views)
    ideal = np.array([pose[:3, 3] for pose in scan_views(TASK.target_m)]) - TASK.target_m
    print(f"ideal rings: coverage {coverage(_unit(ideal)):.3f}", file=sys.stderr)
    turned = np.degrees(sum(path_length(stop.route_rad) for stop in stops))
    print(f"tour: {turned:.0f} degrees of the busiest joint", file=sys.stderr)


def _print_rows(scene: MotionScene, stops: Sequence[Stop]) -> None:
    print("T_flange_camera = [")
    for row in T_FLANGE_CAMERA:
        print(f"    {_toml(row, 6)},")
    print(f"]\nhome_rad = {_toml(HOME_RAD)}")
    for stop in stops:
        view = stop.view
        print(f"\n[[view]]  # {view.elevation_deg:.0f} deg up, azimuth {view.azimuth_deg:.0f} deg")
        print(f"joints_rad = {_toml(view.joints_rad)}")
        print(f"via_rad = [{', '.join(_toml(via) for via in stop.route_rad[1:-1])}]  # from the view before")
        print(f"elevation_deg = {view.elevation_deg:.0f}\nazimuth_deg = {view.azimuth_deg:.0f}")
        print(f"distance_m = {view.distance_m:.2f}\nseen_share = {view.seen_share:.2f}")
        print(f"clearance_mm = {view.clearance_m * 1000:.0f}")
        between = check_path(scene, stop.route_rad.round(4), 0.0).clearance_m
        print(f"clearance_on_the_way_mm = {between * 1000:.0f}")


def _toml(values: FloatArray, digits: int = 4) -> str:
    return "[" + ", ".join(f"{value + 0.0:.{digits}f}" for value in values) + "]"


def _report(what: str, views: Sequence[ReachableView]) -> None:
    covered = coverage(np.array([view.direction for view in views]))
    seen = np.mean([view.seen_share for view in views])
    print(f"{what}: {len(views)} views, coverage {covered:.3f}, box seen {seen:.2f}", file=sys.stderr)


def _report_missing(views: Sequence[ReachableView]) -> None:
    """For each elevation the azimuths that no view of the net has."""
    for elevation in sorted({view.elevation_deg for view in views}):
        there = {view.azimuth_deg for view in views if view.elevation_deg == elevation}
        missing = [azimuth for azimuth in range(-180, 180, 15) if azimuth not in there]
        print(f"elevation {elevation:.0f}: no azimuths {missing}", file=sys.stderr)


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


if __name__ == "__main__":
    main()
