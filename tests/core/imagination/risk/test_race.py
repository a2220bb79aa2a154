import numpy as np
import pytest

from core.imagination.choice import choose_pour, papers_order
from core.imagination.results import PourGrid
from core.imagination.risk.race import ROUND, Race
from core.imagination.risk.result import NOT_TRIED, PourRisk, joined
from core.parameters import Parameters
from core.parameters.risk import RiskParameters

CUP = Parameters().pouring.cup


def grid_of(spilled):
    """Pours of 60 candies, from the spilled ones of a first try without errors."""
    spilled = np.array(spilled, dtype=np.int64)[:, :, None]
    thetas = np.arange(len(spilled)) * np.pi / 4
    pivots = np.zeros((len(spilled), 3, 3))
    return PourGrid(60, 60 - spilled, spilled, thetas, np.array([0.01, 0.02, 0.03]), pivots, ())


def run(grid, spills, settings=None):
    """Let the pours race; `spills` says how many candies a pour spills in its k-th try."""
    race = Race(PourRisk.as_planned(grid), papers_order(grid), settings or RiskParameters())
    rounds = []
    while (planned := race.next_round()) is not None:
        pour, tries = planned
        rounds.append(pour)
        race.record(pour, [spills(pour, k) for k in tries])
    return race.risk, rounds


def test_a_pour_that_stays_clean_is_all_that_is_tried():
    grid = grid_of(np.zeros((8, 3), dtype=int))
    risk, rounds = run(grid, lambda pour, k: 0)
    paper = choose_pour(grid, CUP)
    assert set(rounds) == {(paper.i, paper.j)}
    assert risk.clean_at_least[paper.i, paper.j] >= RiskParameters().sure
    assert risk.n_tries.sum() == 24 + len(rounds) * ROUND
    fewer = RiskParameters(sure=0.6)
    assert run(grid, lambda pour, k: 0, fewer)[0].n_tries.sum() < risk.n_tries.sum()


def test_the_paper_s_choice_gives_way_to_a_pour_that_stands_errors():
    grid = grid_of(np.zeros((8, 3), dtype=int))
    risk, rounds = run(grid, lambda pour, k: 0 if pour == (4, 2) else 1 + k % 2)
    assert rounds[0] == (choose_pour(grid, CUP).i, choose_pour(grid, CUP).j) != (4, 2)
    choice = choose_pour(grid, CUP, risk=risk)
    assert risk.n_tries.sum() <= 24 + RiskParameters().n_tries
    assert (4, 2) not in rounds or (choice.i, choice.j) == (4, 2)
    assert all(risk.n_tries[pour] <= 1 + ROUND for pour in set(rounds) - {(4, 2)}), "they are given up"


def test_what_spills_without_errors_is_not_tried_while_others_are_clean():
    spilled = np.full((8, 3), 7)
    spilled[2, 1] = spilled[5, 0] = 0
    risk, rounds = run(grid_of(spilled), lambda pour, k: int(k % 3 == 0))
    assert set(rounds) == {(2, 1), (5, 0)}
    assert risk.n_tries[0, 0] == 1


def test_the_tries_are_never_more_than_allowed():
    settings = RiskParameters(n_tries=10)
    risk, rounds = run(grid_of(np.zeros((8, 3), dtype=int)), lambda pour, k: 1, settings)
    assert risk.n_tries.sum() == 24 + 10
    assert len(rounds) == 3


def spills_at_times(k, every):
    return int(k % every == every - 1)


def test_a_pour_that_seems_clean_enough_is_tried_until_it_is_sure():
    grid = grid_of(np.zeros((8, 3), dtype=int))
    risk, rounds = run(grid, lambda pour, k: spills_at_times(k, 4))
    n_tries = RiskParameters().n_tries
    assert len(rounds) * ROUND > n_tries, "after these none is sure"
    surest = choose_pour(grid, CUP, risk=risk)
    assert risk.clean_at_least[surest.i, surest.j] >= RiskParameters().wanted_clean
    assert set(rounds[n_tries // ROUND :]) == {(surest.i, surest.j)}


def test_a_pour_that_does_not_seem_so_gets_no_further_tries():
    risk, rounds = run(grid_of(np.zeros((8, 3), dtype=int)), lambda pour, k: spills_at_times(k, 2))
    assert len(rounds) * ROUND == RiskParameters().n_tries
    assert risk.clean_at_least.max() < RiskParameters().wanted_clean


def test_further_tries_come_to_an_end():
    settings = RiskParameters(n_tries=8, sure=0.99, wanted_clean=0.88)
    _, rounds = run(grid_of(np.zeros((8, 3), dtype=int)), lambda pour, k: 0, settings)
    assert len(rounds) * ROUND == 2 * settings.n_tries


def test_more_may_be_wanted_than_is_tried_for():
    settings = RiskParameters(sure=0.7, wanted_clean=0.85)
    risk, _ = run(grid_of(np.zeros((8, 3), dtype=int)), lambda pour, k: 0, settings)
    assert risk.clean_at_least.max() >= settings.wanted_clean


def test_earlier_tries_count_and_only_pours_in_the_order_are_tried_further():
    grid = grid_of(np.zeros((8, 3), dtype=int))
    known, _ = run(grid, lambda pour, k: 0)
    feasible = np.ones((8, 3), dtype=bool)
    assert Race(known, papers_order(grid, feasible), RiskParameters()).next_round() is None, "one is sure"
    surest = choose_pour(grid, CUP, risk=known)
    feasible[surest.i] = False
    race = Race(known, papers_order(grid, feasible), RiskParameters())
    while (planned := race.next_round()) is not None:
        (i, j), tries = planned
        assert feasible[i, j]
        assert tries.start == race.risk.n_tries[i, j], "each try has other errors"
        race.record((i, j), [0] * len(tries))
    assert race.risk.n_tries[surest.i, surest.j] == known.n_tries[surest.i, surest.j]
    choice = choose_pour(grid, CUP, feasible, race.risk)
    assert race.risk.clean_at_least[choice.i, choice.j] >= RiskParameters().sure


def test_where_the_arm_can_make_none_nothing_is_tried():
    known = PourRisk.as_planned(grid_of(np.zeros((8, 3), dtype=int)))
    assert Race(known, [], RiskParameters()).next_round() is None


def test_the_bound_is_the_one_of_the_binomial_distribution():
    """Rule of succession and Beta quantiles, from their closed forms for n of n and 0 of n."""
    risk = PourRisk(60, joined([[[0] * 13, [3] * 4, [0, 2]]]))
    assert risk.clean_at_least[0, 0] == pytest.approx(0.05 ** (1 / 14))
    assert risk.clean_at_least[0, 1] == pytest.approx(1 - 0.95 ** (1 / 5))
    assert risk.expected_clean[0].tolist() == pytest.approx([14 / 15, 1 / 6, 2 / 4])
    assert risk.mean_spilled[0].tolist() == [0, 3, 1]
    assert risk.spilled[0, 2].tolist() == [0, 2] + [NOT_TRIED] * 11


def test_the_surest_pour_wins_and_what_the_arm_cannot_make_does_not():
    grid = grid_of(np.zeros((8, 3), dtype=int))
    tries = [[[0] for _ in range(3)] for _ in range(8)]
    tries[3][1], tries[6][0] = [0] * 9, [0] * 8 + [1]
    risk = PourRisk(60, joined(tries))
    feasible = np.ones((8, 3), dtype=bool)
    surest = choose_pour(grid, CUP, feasible, risk)
    assert (surest.i, surest.j) == (3, 1)
    feasible[3] = False
    surest = choose_pour(grid, CUP, feasible, risk)
    assert (surest.i, surest.j) == (6, 0)


def test_a_risk_survives_the_disk(tmp_path):
    risk = PourRisk(60, joined([[[0, 1], [5]], [[0], [0, 0, 2]]]))
    risk.save(tmp_path)
    again = PourRisk.load(tmp_path)
    assert (again.spilled == risk.spilled).all()
    assert again.n_pour == 60
