import ast
from pathlib import Path

import numpy as np
import pytest

import hardware.simulation.pour_outcome as package
from core.mesh import TriangleMesh
from core.parameters.settings import describe
from hardware.simulation.pour_outcome.outcome import TableOutcome
from hardware.simulation.pour_outcome.settings import OutcomeSettings
from tests.hardware.simulation.pour_outcome.conftest import Simulate, pivot_above
from tests.hardware.simulation.pour_outcome.paths import tipping_path

FOLDER = Path(package.__file__).parent
ALTERED = {
    "engine": "mujoco",
    "seed": 1,
    "n_candies": 9,
    "candy_shape": "tablet",
    "candy_diameter_m": 0.0125,
    "candy_height_m": 0.0065,
    "candy_mass_kg": 0.002,
    "size_spread": 0.05,
    "batch_spread": 0.2,
    "candy_friction": 0.6,
    "cup_friction": 0.1,
    "object_friction": 0.1,
    "table_friction": 0.1,
    "rolling_arm_m": 0.002,
    "candy_restitution": 0.6,
    "wall_restitution": 0.1,
    "object_error_m": 0.02,
    "object_error_rad": 0.3,
    "cup_slip_m": 0.005,
    "cup_slip_rad": 0.1,
    "rate_hz": 500,
    "iterations": 10,
    "safe_move_m": 0.0005,
    "max_substeps": 2,
    "contact_breaking_m": 0.004,
    "settle_s": 0.5,
    "rest_s": 0.2,
    "resting_m_s": 0.2,
    "record_interval_s": 0.1,
}
COUNTING = {"rim_margin_m"}
"""Tested with the counting."""
OF_MUJOCO = {"contact_rad_s": 700.0, "slow_step_s": 0.0005}


def same(one: TableOutcome, other: TableOutcome) -> bool:
    return np.array_equal(one.positions_m, other.positions_m) and np.array_equal(
        one.recording.time_s, other.recording.time_s
    )


@pytest.fixture(scope="module")
def rim_m(bowl: TriangleMesh) -> np.ndarray:
    """Above the bowl's rim: some candies fall into the bowl, some beside it."""
    return pivot_above(bowl, -0.01) + np.array([0, 0.025, 0])


@pytest.fixture(scope="module")
def usual(simulate: Simulate, bowl: TriangleMesh, rim_m: np.ndarray) -> TableOutcome:
    return simulate(bowl, tipping_path(rim_m), n_candies=8)


def test_the_usual_pour_touches_bowl_and_platform(usual: TableOutcome) -> None:
    assert usual.n_in_object > 0
    assert usual.n_spilled > 0


def test_all_settings_are_looked_at() -> None:
    assert {facts.name for facts in describe(OutcomeSettings())} == set(ALTERED) | set(OF_MUJOCO) | COUNTING


@pytest.mark.system
@pytest.mark.parametrize("name", ALTERED)
def test_each_setting_is_felt(
    simulate: Simulate, bowl: TriangleMesh, rim_m: np.ndarray, usual: TableOutcome, name: str
) -> None:
    altered = simulate(bowl, tipping_path(rim_m), **{"n_candies": 8} | {name: ALTERED[name]})
    assert not same(usual, altered)


@pytest.mark.system
@pytest.mark.parametrize("name", OF_MUJOCO)
def test_each_setting_of_mujoco_is_felt(
    simulate: Simulate, bowl: TriangleMesh, rim_m: np.ndarray, name: str
) -> None:
    usual, altered = (
        simulate(bowl, tipping_path(rim_m), n_candies=4, engine="mujoco", **changes)
        for changes in ({}, {name: OF_MUJOCO[name]})
    )
    assert not same(usual, altered)


def test_every_setting_has_unit_range_and_source() -> None:
    for facts in describe(OutcomeSettings()):
        assert facts.doc
        assert facts.source
        assert facts.choices or (facts.low is not None and facts.high is not None)


def test_nothing_is_taken_from_the_imagination_but_geometry_and_forms() -> None:
    """The cup's measures belong to both; whatever else is a parameter there must not be known here."""
    allowed = {
        "core.imagination.body": {"BodyFile", "body_files"},
        "core.imagination.cup": {"cup_parts", "inner_radius_m"},
        "core.imagination.engine": {"bullet"},
        "core.imagination.recording": {"Recorder", "Recording"},
        "core.parameters.fields": {"OURS", "Group", "choice", "quantity"},
        "core.parameters.settings": {"apply_settings"},
        "core.parameters.bodies": {"CupParameters"},
    }
    for file in sorted(FOLDER.glob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            names = (
                {alias.name for alias in node.names}
                if isinstance(node, ast.Import | ast.ImportFrom)
                else set()
            )
            if isinstance(node, ast.Import):
                assert not any(name.startswith(("core.imagination", "core.parameters")) for name in names)
            elif isinstance(node, ast.ImportFrom) and str(node.module).startswith(
                ("core.imagination", "core.parameters")
            ):
                assert names <= allowed.get(str(node.module), set()), f"{file.name}: {node.module}"
