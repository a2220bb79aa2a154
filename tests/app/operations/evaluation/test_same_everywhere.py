"""The same trials, bit for bit, whatever computes them."""

import hashlib

import pytest

from app.operations.evaluating import evaluate
from app.operations.evaluation.dask_engine import DaskEngine
from app.operations.evaluation.engine import LocalEngine
from core.evaluation.variants import variants_of
from core.mesh_file import write_mesh
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from hardware.simulation.objects import builtin_object
from tests.app.operations.evaluation.fakes import request_for, write_labels

pytestmark = pytest.mark.system

QUICK = apply_settings(
    Parameters(),
    {
        "reconstruction.voxel_m": 0.004,
        "containability.n_max": 40,
        "containability.n_min": 20,
        "containability.omega_threshold": 0.1,
        "capacity.n_fillings": 1,
        "capacity.n_aimed": 20,
        "capacity.lattice_points": 50_000,
        "holding.n_load": 6,
        "holding.tilt_step_rad": 0.2,
        "risk.n_tries": 4,
        "pouring.n_pour": 20,
        "pouring.theta_fixed_rad": 0.0,
    },
)


@pytest.fixture(scope="module")
def known(tmp_path_factory):
    """Three objects whose meshes are known."""
    folder = tmp_path_factory.mktemp("known")
    for name in ("bowl", "ring", "block"):
        write_mesh(folder / f"{name}.obj", builtin_object(name))
    write_labels(folder, bowl="container", ring="ambiguous", block="non-container")
    return folder


@pytest.fixture(scope="module")
def scanned(tmp_path_factory):
    """One object that is scanned."""
    folder = tmp_path_factory.mktemp("scanned")
    write_mesh(folder / "glass.obj", builtin_object("glass"))
    write_labels(folder, glass="container")
    return folder


def bits(engine, known, scanned, out):
    """All trials, by both verdicts, without their seconds, and the digests of their pictures."""
    found = []
    variants = variants_of(["imagination", "threshold-0"])
    for request in (
        request_for(known, parameters=QUICK, variants=variants),
        request_for(scanned, parameters=QUICK, source="scan"),
    ):
        folder = out / request.source
        for trial in evaluate(request, engine, folder, Reporter()).trials:
            picture = (folder / "pictures" / trial.picture).read_bytes()
            table = trial.to_table() | {"seconds": None}
            found.append((table, hashlib.sha256(picture).hexdigest()))
    return found


def test_one_worker_two_workers_and_a_cluster_agree(known, scanned, cluster_address, tmp_path):
    one = bits(LocalEngine(1), known, scanned, tmp_path / "one")
    assert [table["problem"] for table, _ in one] == [""] * 7
    assert [table["name"] for table, _ in one if table["spilled"]] == ["bowl", "bowl", "glass"]
    assert bits(LocalEngine(2), known, scanned, tmp_path / "two") == one
    assert bits(DaskEngine(cluster_address), known, scanned, tmp_path / "cluster") == one
