"""Where the candies end when the cup is driven along its real path: the ground-truth simulation."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import InputError
from core.files import read_arrays, read_json, write_arrays, write_json
from core.geometry import BoolArray, FloatArray, invert_pose, make_pose, rotation_z, transform_points
from core.imagination.recording import Recording
from core.mesh import TriangleMesh
from core.parameters.bodies import CupParameters
from core.progress import Reporter
from core.workers import TaskRunner
from hardware.simulation.pour_outcome.bodies import Bodies, PlatformBox
from hardware.simulation.pour_outcome.candies import NO_CANDIES, Candies, fill_cup, thickness_m
from hardware.simulation.pour_outcome.counting import in_object
from hardware.simulation.pour_outcome.driven_path import DrivenPath, cup_motion
from hardware.simulation.pour_outcome.playing import PlayedPour, pour_task
from hardware.simulation.pour_outcome.settings import OutcomeSettings

_UPRIGHT_COSINE = 0.95
_TABLE_FILE, _ARRAY_FILE = "outcome.json", "outcome.npz"


@dataclass(frozen=True)
class TableOutcome:
    """Where N candies ended: those of the cup, after them those that lay in the object before.

    Attributes:
        in_object: (N,) at the end above the object's surface, within its AABB.
        in_cup: (N,) still in the cup.
        positions_m: (N, 3) final centres in the base frame.
        scales: (N,) the candies' sizes, relative to the mean size.
        T_given_stood: (4, 4) takes points of the mesh as given to where the object really stood.
        recording: candies and cup; its time is that since the driven path's first sample.
    """

    in_object: BoolArray
    in_cup: BoolArray
    positions_m: FloatArray
    scales: FloatArray
    T_given_stood: FloatArray
    recording: Recording

    @property
    def n_candies(self) -> int:
        """Candies that were in the cup, or lay in the object, at first."""
        return len(self.in_object)

    @property
    def lying(self) -> Candies:
        """The candies that lie in the object now."""
        inside = self.in_object
        quaternions = self.recording.quaternions[-1][inside].astype(float)
        found = Candies(self.scales[inside], self.positions_m[inside], quaternions)
        return found.moved(invert_pose(self.T_given_stood))

    @property
    def n_in_object(self) -> int:
        """Candies poured in."""
        return int(self.in_object.sum())

    @property
    def n_in_cup(self) -> int:
        """Candies that never left the cup."""
        return int(self.in_cup.sum())

    @property
    def n_spilled(self) -> int:
        """All others: on the platform, on the table, or beside it."""
        return self.n_candies - self.n_in_object - self.n_in_cup

    def save(self, folder: Path) -> None:
        """Write `outcome.json` and `outcome.npz`."""
        table: dict[str, Any] = {
            "n_candies": self.n_candies,
            "n_in_object": self.n_in_object,
            "n_in_cup": self.n_in_cup,
            "n_spilled": self.n_spilled,
            "T_given_stood": self.T_given_stood.tolist(),
        }
        write_json(folder / _TABLE_FILE, table)
        write_arrays(
            folder / _ARRAY_FILE,
            in_object=self.in_object,
            in_cup=self.in_cup,
            positions_m=self.positions_m,
            scales=self.scales,
            **self.recording.to_arrays(),
        )

    @classmethod
    def load(cls, folder: Path) -> TableOutcome:
        """Read what `save` wrote.

        Raises:
            SessionError: a file is missing or damaged.
        """
        table, arrays = read_json(folder / _TABLE_FILE), read_arrays(folder / _ARRAY_FILE)
        return cls(
            arrays["in_object"],
            arrays["in_cup"],
            arrays["positions_m"],
            arrays["scales"],
            np.array(table["T_given_stood"]),
            Recording.from_arrays(arrays),
        )


def simulate_outcome(
    mesh: TriangleMesh,
    path: DrivenPath,
    cup: CupParameters,
    table_height_m: float,
    platform: PlatformBox,
    settings: OutcomeSettings,
    pool: TaskRunner,
    reporter: Reporter,
    lying: Candies = NO_CANDIES,
) -> TableOutcome:
    """Drive a cup of candies along a path over the true object and count them (Sec. IV-D).

    The cup stands at the path's first pose until the candies in it are at rest. The physics runs in a worker.

    Args:
        mesh: the true object where it is believed to stand, in the base frame.
        path: the cup's poses in the base frame, as driven; it begins with the cup upright.
        cup: the cup's measures.
        table_height_m: of the table's top.
        platform: what carries the object.
        settings: the table's own parameters.
        pool: where to compute.
        reporter: receives the progress.
        lying: candies that are in the object already.

    Raises:
        InputError: the path does not begin with the cup upright, or the cup cannot hold the candies.
        Cancelled: the reporter was asked to stop.
        WorkerError: the worker died.
    """
    if path.T_base_cup[0, 2, 2] < _UPRIGHT_COSINE:
        raise InputError(
            "The driven path does not begin with the cup upright, so it cannot be filled; record the pour "
            "from the moment at which the cup stands at its station."
        )
    candies = fill_cup(cup, settings)
    T_given_stood = _stood(mesh, settings)
    stood = TriangleMesh(transform_points(T_given_stood, mesh.vertices_m), mesh.faces)
    since_start = DrivenPath(path.times_s - path.times_s[0], path.T_base_cup)
    motion = cup_motion(since_start.trimmed().in_hand(_slipped(settings)), settings.rate_hz)
    bodies = Bodies(stood, cup, table_height_m, platform)
    task = pour_task(bodies, candies, lying.moved(T_given_stood), motion, settings)
    played: PlayedPour = pool.run([task], "outcome", reporter)[0]
    lie_in = in_object(
        stood,
        played.positions_m,
        platform.height_m,
        settings.rim_margin_m,
        (settings.candy_diameter_m, thickness_m(settings)),
    )
    inside = lie_in & ~played.in_cup
    scales = np.concatenate([candies.scales, lying.scales])
    return TableOutcome(inside, played.in_cup, played.positions_m, scales, T_given_stood, played.recording)


def _stood(mesh: TriangleMesh, settings: OutcomeSettings) -> FloatArray:
    """`T_given_stood` (4, 4): shifted in the plane and rotated about the vertical through its middle."""
    random = np.random.default_rng([settings.seed, 2])
    direction, sense = random.uniform(0, 2 * np.pi), random.choice([-1.0, 1.0])
    middle = (mesh.aabb_min_m + mesh.aabb_max_m) / 2
    rotation = rotation_z(sense * settings.object_error_rad)
    shift = settings.object_error_m * np.array([np.cos(direction), np.sin(direction), 0.0])
    return make_pose(rotation, middle - rotation @ middle + shift)


def _slipped(settings: OutcomeSettings) -> FloatArray:
    """`T_cup_slipped` (4, 4): shifted in any direction and leaning in any other."""
    from scipy.spatial.transform import Rotation

    random = np.random.default_rng([settings.seed, 3])
    shift, towards = random.standard_normal(3), random.uniform(0, 2 * np.pi)
    lean = settings.cup_slip_rad * np.array([np.cos(towards), np.sin(towards), 0.0])
    return make_pose(
        Rotation.from_rotvec(lean).as_matrix(), settings.cup_slip_m * shift / np.linalg.norm(shift)
    )
