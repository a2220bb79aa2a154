"""`poursight tune`: a real small fit, spills from the ground-truth simulation, Ctrl-C, what is refused."""

import os
import signal
import subprocess
import sys
import time

import pytest

from app.library import places
from core.evaluation.fitting.provenance import read_provenance
from core.evaluation.fitting.spills import read_spills
from core.mesh_file import write_ply
from core.parameters import Parameters, flatten, load_preset
from hardware.simulation.objects import builtin_object
from tests.awake import within
from tests.patience import HANG_S

pytestmark = pytest.mark.system

QUICK = (
    "containability.verdict=omega",
    "containability.n_max=30",
    "containability.n_min=10",
    "containability.rotation_s=0.5",
    "containability.contact.rolling_friction=0.3",
    "containability.contact.spinning_friction=0.3",
    "solver.substeps=2",
    "particle.diameter_m=0.012",
    "particle.height_m=0.006",
    "pouring.n_packings=1",
    "pouring.n_pour=8",
    "reconstruction.voxel_m=0.004",
)
SETTINGS = [word for setting in QUICK for word in ("--set", setting)]


@pytest.fixture(autouse=True)
def own_folders(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))


@pytest.fixture
def objects(tmp_path):
    folder = tmp_path / "objects"
    folder.mkdir()
    for name in ("mug", "bowl", "block"):
        write_ply(folder / f"{name}.ply", builtin_object(name))
    (folder / "labels.csv").write_text("id,label\nmug,container\nbowl,container\nblock,non-container\n")
    return folder


def words(objects, out, *more):
    return ("calibrate", objects, "--out", out, "--input", "mesh", "--workers", 2, *SETTINGS, *more)


def test_a_small_fit_becomes_one_of_the_users_presets(poursight, objects):
    code, out, err = poursight(*words(objects, "My fit", "--seeds", 2, "--trials", 4, "--seed", 5))
    assert code == 0, err
    path = places.presets_folder() / "my-fit.json"
    found = read_provenance(path)
    assert found is not None and f"Preset: {path}" in out
    assert found.objects == {"mug": "container", "bowl": "container", "block": "non-container"}
    assert found.seeds == (5, 6) and found.search["done"] == 4
    assert [one["seed"] for one in found.after["by_seed"]] == [5, 6]
    assert found.after["margin"] >= found.before["margin"]
    assert found.measure == "Omega" and "trial 1 of 4, start: Omega margin" in err
    assert "containability.omega_threshold" in out and "Omega: margin" in out
    values = flatten(load_preset(str(path)))
    assert values["containability.omega_threshold"] == found.after["threshold"] > 0
    assert values["particle.diameter_m"] == 0.012 and values["seed"] == 0
    friction = "containability.contact"
    assert values[f"{friction}.rolling_friction"] == values[f"{friction}.spinning_friction"]


def test_by_capacity_its_threshold_is_fitted(poursight, objects, tmp_path):
    (objects / "labels.csv").write_text("id,label\nbowl,container\nblock,non-container\n")
    out = tmp_path / "fit.json"
    few = ("containability.verdict=capacity", "capacity.n_fillings=1", "capacity.lattice_points=50000")
    settings = [word for setting in few for word in ("--set", setting)]
    code, said, err = poursight(*words(objects, out, "--seeds", 1, "--trials", 1, *settings))
    assert code == 0, err
    found = read_provenance(out)
    assert found.measure == "Capacity share" and "start: capacity share margin" in err
    assert "containability.capacity_threshold" in said and "Capacity share: margin" in said
    assert "omega" not in said.lower()
    values = flatten(load_preset(str(out)))
    assert values["containability.capacity_threshold"] == found.after["threshold"] > 0.1
    assert values["containability.omega_threshold"] == Parameters().containability.omega_threshold


def test_spills_are_measured_in_the_ground_truth_simulation_and_fitted_to(poursight, objects, tmp_path):
    (objects / "labels.csv").write_text("id,label\nbowl,container\nblock,non-container\n")
    csv, out = tmp_path / "spills.csv", tmp_path / "fit.json"
    wanted = words(objects, out, "--spills-from-truth", csv, "--trials", 2, "--seeds", 1)
    one = ("--parameter", "pouring.contact.lateral_friction=0.05:0.7")
    code, said, err = poursight(*wanted, *one)
    assert code == 0, err
    rows = read_spills(csv)
    assert len(rows) == 24 and {row.name for row in rows} == {"bowl"}
    assert {row.n_pour for row in rows} == {8}
    spills = read_provenance(out).spills
    assert spills["n"] == 24 and spills["after"] <= spills["before"]
    assert [one["name"] for one in spills["fitted"]] == ["pouring.contact.lateral_friction"]
    assert "Spills: " in said
    assert "is there already" in poursight(*wanted)[2]


def test_stopped_by_ctrl_c_the_best_is_kept(objects, tmp_path):
    out = tmp_path / "fit.json"
    started = [sys.executable, "-m", "app.cli", *map(str, words(objects, out, "--trials", 500, "--seeds", 1))]
    with subprocess.Popen(started, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        while "trial 1 of 500" not in process.stderr.readline():
            assert process.poll() is None
        time.sleep(1)
        with within(5):
            os.kill(process.pid, signal.SIGINT)
            out_text, err = process.communicate(timeout=HANG_S)
    assert process.returncode == 0, err
    assert "the best so far is kept" in err and "Preset:" in out_text
    assert read_provenance(out).search["is_cut_short"] is True


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (("--parameter", "containability.rotation"), "did you mean"),
        (("--parameter", "pouring.contact.restitution"), "can be fitted to measured spills only"),
        (("--spills", "gone.csv"), "gone.csv cannot be read"),
        (("--labels", "gone.csv"), "gone.csv cannot be read"),
        (("--preset", "defolt"), "did you mean 'default'"),
    ],
)
def test_what_cannot_be_used_is_a_sentence(refused, objects, tmp_path, more, said):
    assert said in refused(*words(objects, tmp_path / "fit.json", *more))


def test_where_the_preset_cannot_go(refused, objects, tmp_path):
    assert "There is no folder" in refused(*words(objects, tmp_path / "gone" / "fit.json"))
    assert "is the name of a preset that the program ships" in refused(*words(objects, "paper"))


def test_spills_of_an_object_without_a_label(refused, objects, tmp_path):
    spills = tmp_path / "spills.csv"
    spills.write_text("object,theta,indent,spilled\npot,0,0.01,3\n")
    assert "'pot' are given, but the labels name no such object" in refused(
        *words(objects, tmp_path / "fit.json", "--spills", spills)
    )


def test_both_kinds_of_spills_are_wrong_usage(poursight, objects, tmp_path):
    code, _, err = poursight(
        *words(objects, tmp_path / "fit.json", "--spills", "a.csv", "--spills-from-truth", "b.csv")
    )
    assert code == 2 and "either --spills" in err
