"""What the Pours page reads and says, without a window."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.gui.pages.pours.choice import chosen_sentence, feasibility_sentence, risk_warning, why_sentences
from app.gui.pages.pours.comparison import (
    OtherPours,
    comparison_sentence,
    load_grid,
    one_direction,
    scratch_session,
)
from app.gui.pages.pours.pour_scene import map_rotation_deg
from app.gui.pages.pours.results import PoursKey, load_pours
from app.operations.choosing import current_motions
from core.errors import SessionError
from core.imagination.risk.result import PourRisk, joined
from core.session import Session
from core.session.operator_choice import CHOICE_FILE
from hardware.cell import SIMULATED_CELL, read_cell


@pytest.fixture
def cell():
    return read_cell(SIMULATED_CELL)


def test_a_container_with_what_the_arm_can_do(mug_session, cell):
    pours = load_pours(PoursKey(mug_session, cell, None))
    assert pours.grid.p.shape == (8, 3)
    assert pours.motions is not None and pours.is_in_cell
    said = chosen_sentence(pours)
    assert said.startswith("Chosen: from ") and "reachable" in said and said.endswith(" mm clearance.")
    assert "The arm can make" in why_sentences(pours)[-1]
    again = load_pours(PoursKey(mug_session, cell, pours))
    assert again.grid is pours.grid, "what is the same is not read again"


def test_the_replay_ends_as_it_was_counted(mug_session, cell):
    pours = load_pours(PoursKey(mug_session, cell, None))
    for i, j in np.ndindex(8, 3):
        counted = pours.grid.n_in[i, j, 0]
        assert abs(int(pours.landed(i, j).sum()) - counted) <= 1, "positions are kept in steps of 0.1 mm"


def test_the_level_of_the_amount_is_a_band_in_the_object(mug_session, cell):
    pours = load_pours(PoursKey(mug_session, cell, None))
    level = pours.fill_line
    assert level is not None
    assert level.n_candies == pours.amount.n_total
    heights_m = level.band.vertices_m[:, 2] - pours.body.vertices_m[:, 2].min()
    assert np.ptp(heights_m) < 0.002
    assert pours.amount.fill_height_m < heights_m.mean() < pours.amount.fill_height_m + 0.02, "floor and base"


def test_motions_for_another_cell_do_not_count(mug_session, cell):
    moved = cell.model_copy(update={"robot": cell.robot.model_copy(update={"address": "10.0.0.7"})})
    assert current_motions(Session.open(mug_session), cell) is not None
    pours = load_pours(PoursKey(mug_session, moved, None))
    assert pours.motions is None
    assert "not yet checked with the arm" in chosen_sentence(pours)


def test_no_container_says_why_with_numbers(block_session, cell):
    pours = load_pours(PoursKey(block_session, cell, None))
    assert pours.grid is None and pours.chosen is None
    assert "not an open container" in chosen_sentence(pours)
    assert (
        "Not an open container: hollow for 0\xa0% of its bulk (containers: over 10\xa0%)"
        in why_sentences(pours)[0]
    )


def test_a_mesh_is_in_no_cell(mug_session, cell):
    pours = replace(load_pours(PoursKey(mug_session, cell, None)), motions=None, is_in_cell=False)
    assert chosen_sentence(pours).endswith("imagined only.")
    assert "not in the cell" in feasibility_sentence(pours, *pours.chosen)


def test_a_damaged_choice_is_reported(mug_session, cell):
    (mug_session / CHOICE_FILE).write_text("{")
    pours = load_pours(PoursKey(mug_session, cell, None))
    assert pours.operator is None and "withdraw" in pours.problem
    assert pours.problem in why_sentences(pours)


def test_a_direction_of_the_grid_needs_no_run(mug_session, cell):
    grid = load_pours(PoursKey(mug_session, cell, None)).grid
    row = one_direction(grid, float(grid.theta_rad[3]) + 2 * np.pi)
    assert np.array_equal(row.p, grid.p[3:4])
    assert one_direction(grid, float(grid.theta_rad[3]) + 0.2) is None
    other = OtherPours("fixed", row)
    assert np.array_equal(other.ratios_for(grid), np.repeat(grid.p[3:4], 8, axis=0))
    assert "just as good" in comparison_sentence(grid, OtherPours("itself", grid))


def test_each_pour_is_compared_with_the_nearest_direction(mug_session, cell):
    grid = load_pours(PoursKey(mug_session, cell, None)).grid
    turned = np.roll(np.arange(8), 3)
    other = OtherPours(
        "turned",
        type(grid)(
            grid.n_pour,
            grid.n_in[turned],
            grid.n_spilled[turned],
            grid.theta_rad[turned] + 0.1,
            grid.indent_m,
            grid.pivot_m[turned],
            tuple(grid.recordings[k] for k in turned),
        ),
    )
    assert np.array_equal(other.ratios_for(grid), grid.p)
    assert other.farthest_rad(grid) == pytest.approx(0.1)
    assert "differ by up to 6°" in comparison_sentence(grid, other)


def test_a_scratch_session_has_the_collision_model_and_no_pours(mug_session, tmp_path):
    scratch = scratch_session(mug_session, tmp_path / "home")
    session = Session.open(scratch)
    assert session.record("collision") is not None
    assert session.record("pouring") is None
    shutil.rmtree(scratch)
    assert Session.open(mug_session).record("collision") is not None


def test_what_has_no_pours_cannot_be_compared_with(block_session, tmp_path):
    with pytest.raises(SessionError, match="not an open container"):
        load_grid(block_session)
    with pytest.raises(SessionError, match="no session"):
        load_grid(Path(tmp_path / "nowhere"))


@pytest.mark.parametrize(("azimuth", "rotation"), [(-90, 0), (-60, -30), (0, -90), (180, 90), (90, -180)])
def test_the_map_lies_as_the_view_does(azimuth, rotation):
    assert map_rotation_deg(azimuth) == pytest.approx(rotation)


@pytest.mark.parametrize(("n_clean", "warns"), [(13, False), (12, True)])
def test_the_heading_warns_where_a_clean_pour_is_not_sure(mug_session, n_clean, warns):
    shown = load_pours(PoursKey(mug_session, None, None))
    i, j = shown.chosen
    tries = [[[0] for _ in range(3)] for _ in range(8)]
    tries[i][j] = [0] * n_clean + [3] * (13 - n_clean)
    risky = replace(shown, imagined_risk=PourRisk(20, joined(tries)), motions=None)
    assert ("A clean pour is only" in risk_warning(risky)) is warns
