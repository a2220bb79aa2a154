"""Are scans of a freshly calibrated simulated cell as good as those of the perfect one?

Usage: python -m tests.benchmarks.calibrated_scans [--cells N] [--objects NAME,...] (make calibrated-scans)
Each cell is made anew: its camera hangs up to 20 mm and 10 degrees beside where the file has it, its arm
comes to rest within 0.3 mm and 0.03 degrees, and the program calibrates it from 20 rendered images. Every
object is then scanned in that cell, and in the same one whose file has the truth: same place, same noise.
Errors are those of `tests/benchmarks/accuracy.py`, from the true surface to the reconstruction and back, in
millimetres; the last column is how far the means of both are apart.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from app.operations.calibration.cell_file import new_cell
from app.operations.calibration.hand_eye import calibrate_cell
from app.operations.calibration.steps import enter_board
from core.calibration.board import BoardSpec
from core.calibration.rig import log_pose
from core.geometry import FloatArray, invert_pose
from core.parameters import Parameters
from core.progress import Reporter
from core.reconstruction.stage import reconstruct
from hardware.cell import read_cell
from hardware.cell.scene import object_space
from hardware.cell.settings import CellSettings
from hardware.scanning.simulated import simulate_scan
from hardware.simulation.placing import place_on_platform, transform_mesh
from tests.benchmarks.accuracy import OBJECTS, Truth, make_object

FORTH, BACK = 1, 3
"""Of the columns of `Truth.judge`: means from the truth to the reconstruction, and back."""
WANTED_MM = 0.2


def calibrated_cell(seed: int) -> CellSettings:
    """A new cell, calibrated; prints how far off the result is."""
    path = new_cell(f"cell {seed}", is_simulated=True, seed=seed)
    enter_board(path, BoardSpec(), "a4", 0.030)
    found = calibrate_cell(path, Reporter(), None)
    settings = read_cell(path)
    off = log_pose(invert_pose(settings.camera.pose) @ settings.true_camera_pose)
    print(
        f"cell {seed}: {found.n_views} views; the camera is {1000 * np.linalg.norm(off[3:]):.2f} mm and "
        f"{np.degrees(np.linalg.norm(off[:3])):.3f} degrees off, "
        f"{1000 * found.bounds.pouring_m:.2f} mm stated",
        flush=True,
    )
    return settings


def with_true_camera(settings: CellSettings) -> CellSettings:
    """The same cell, whose file has the camera where it hangs."""
    rows = tuple(tuple(row) for row in settings.true_camera_pose.tolist())
    return settings.model_copy(
        update={"camera": settings.camera.model_copy(update={"T_flange_camera": rows})}
    )


def errors_mm(name: str, seed: int, settings: CellSettings) -> FloatArray:
    """Mean errors (2,) forth and back of one scan."""
    mesh = make_object(name)
    scan = simulate_scan(mesh, seed, Reporter(), cell=settings)
    stands = place_on_platform(mesh, seed, settings.place, object_space(settings))
    truth = Truth(transform_mesh(mesh, stands), scan)
    found = truth.judge(reconstruct(scan, Parameters().reconstruction, Reporter()).mesh)
    return np.array([found[FORTH], found[BACK]])


def main() -> None:
    """Run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cells", type=int, default=3)
    parser.add_argument("--objects", default=",".join(OBJECTS))
    given = parser.parse_args()
    with TemporaryDirectory(prefix="poursight-cells-") as folder:
        os.environ["POURSIGHT_CELLS"] = str(Path(folder))
        cells = [calibrated_cell(seed) for seed in range(given.cells)]
    titles = ("perfect forth", "back", "calibrated forth", "back", "apart")
    print(f"{'':12}" + "".join(f"{title:>18}" for title in titles))
    apart = []
    for name in given.objects.split(","):
        both = [
            (errors_mm(name, seed, with_true_camera(cell)), errors_mm(name, seed, cell))
            for seed, cell in enumerate(cells)
        ]
        perfect, calibrated = np.array(both).mean(axis=0)
        apart.append(float(np.abs(calibrated - perfect).max()))
        row = (*perfect, *calibrated, apart[-1])
        print(f"{name:12}" + "".join(f"{value:18.2f}" for value in row), flush=True)
    n_within = sum(value <= WANTED_MM for value in apart)
    print(f"{n_within} of {len(apart)} objects within {WANTED_MM} mm; worst {max(apart):.2f} mm")


if __name__ == "__main__":
    main()
