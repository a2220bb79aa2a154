import pytest

from core.collision import CollisionModel
from core.imagination.context import Ahead, ImaginationContext
from core.imagination.drop import imagine_drop
from core.imagination.judgement import Judgement, judge, judge_ahead
from core.mesh import TriangleMesh
from core.mesh_topology import join
from core.parameters import apply_settings
from core.pipeline.in_memory import imagine
from core.progress import Reporter
from core.report.sentences import verdict_sentence
from core.unseen_readings import UnseenReadings
from core.workers import RunHere
from tests.core.imagination.conftest import box

FEW = {
    "containability.verdict": "capacity",
    "particle.shape": "ellipsoid",
    "particle.diameter_m": 0.0132,
    "particle.height_m": 0.007,
    "particle.mass_kg": 0.0009,
    "containability.contact.lateral_friction": 0.2,
    "capacity.n_fillings": 1,
    "holding.n_load": 6,
    "holding.tilt_step_rad": 0.2,
    "risk.n_tries": 0,
    "pouring.n_packings": 1,
}


@pytest.fixture(scope="module")
def few(quick):
    return apply_settings(quick, FEW)


@pytest.fixture(scope="module")
def dish_judged(dish, few, pool):
    return imagine(dish, few, pool, Reporter())


def test_a_dish_is_a_container_for_most_of_it_is_room(dish_judged):
    verdict = dish_judged.containability.verdict
    assert verdict.is_container
    room_ml, hull_ml = 90 * 50 * 35 / 1000, 100 * 60 * 40 / 1000
    assert verdict.capacity_share == pytest.approx(room_ml / hull_ml, rel=0.25)
    assert verdict.volume_ml == pytest.approx(room_ml, rel=0.25)
    assert dish_judged.retention.holds_rad > 0.3
    assert dish_judged.grid is not None


def test_a_block_is_none_though_some_candies_lie_on_it(block, few, pool):
    still = {"containability.rotation_rad": 0.0, "containability.contact.lateral_friction": 1.0}
    found = imagine(block, apply_settings(few, still), pool, Reporter())
    assert not found.containability.is_open_container
    assert found.containability.verdict.capacity_share < 0.02
    assert found.grid is None


def test_the_threshold_decides_and_omega_is_told_beside(dish_judged, dish, few, pool):
    strict = apply_settings(few, {"containability.capacity_threshold": 0.95})
    found = imagine(dish, strict, pool, Reporter()).containability
    assert not found.is_open_container
    assert found.exceeds_omega
    assert found.omega == dish_judged.containability.omega


def test_by_the_papers_rule_nothing_is_filled(dish, few, pool):
    by_omega = apply_settings(few, {"containability.verdict": "omega"})
    found = imagine(dish, by_omega, pool, Reporter())
    assert (found.capacity, found.retention, found.containability.verdict) == (None, None, None)
    assert found.containability.is_open_container == found.containability.exceeds_omega


def test_a_judgement_survives_the_disk(dish_judged, tmp_path):
    found = dish_judged.containability
    judged = Judgement(found.omega_threshold, found.verdict, dish_judged.capacity)
    for case, folder in ((judged, tmp_path / "by_capacity"), (Judgement(0.1), tmp_path / "by_omega")):
        folder.mkdir()
        case.save(folder)
        again = Judgement.load(folder)
        assert (again.omega_threshold, again.verdict) == (case.omega_threshold, case.verdict)
        assert (again.capacity is None) == (case.capacity is None)


@pytest.fixture(scope="module")
def pipe(dish) -> TriangleMesh:
    """The dish without its floor."""
    return join(dish.parts[1:])


def test_a_solid_block_whose_inside_nobody_saw_may_be_a_dish(dish, block, few, pool):
    moved = block.surface.translated(dish.aabb_min_m - block.aabb_min_m)
    hidden = CollisionModel.exact(moved, UnseenReadings(120.0, dish.surface))
    verdict = imagine(hidden, few, pool, Reporter()).containability.verdict
    assert verdict.is_undecided and not verdict.is_container
    assert verdict.other_share > 0.4
    assert verdict.unseen_ml == 120.0


def test_a_dish_whose_bottom_nobody_saw_may_be_a_pipe(dish, pipe, few, pool):
    hidden = CollisionModel.exact(dish.surface, UnseenReadings(40.0, dish.surface, pipe))
    found = imagine(hidden, few, pool, Reporter())
    assert found.containability.is_undecided
    assert found.containability.verdict.other_share < 0.02
    assert found.grid is None, "nothing is poured into what may be a pipe"


@pytest.mark.system
def test_the_unseen_does_not_matter_where_the_answer_stays(dish, few, pool):
    hidden = CollisionModel.exact(dish.surface, UnseenReadings(10.0, dish.surface, dish.surface))
    verdict = imagine(hidden, few, pool, Reporter()).containability.verdict
    assert verdict.is_container and not verdict.is_undecided
    assert verdict.other_share == verdict.capacity_share


@pytest.mark.system
def test_what_no_view_saw_of_a_hollow_is_told_with_it(dish, few, pool):
    floor = box((0, 0, 0), (0.1, 0.06, 0.02)).translated(dish.aabb_min_m)
    shallow = join([*dish.parts, floor])
    hidden = CollisionModel.exact(shallow, UnseenReadings(60.0, dish.surface))
    found = imagine(hidden, few, pool, Reporter())
    seen = imagine(CollisionModel.exact(shallow), few, pool, Reporter())
    verdict, capacity = found.containability.verdict, found.capacity
    assert verdict.is_container and not verdict.is_undecided
    assert seen.capacity.hidden_ml == 0 < capacity.hidden_ml
    assert verdict.level_ml == pytest.approx(seen.capacity.level_ml + capacity.hidden_ml)
    assert verdict.level_ml == pytest.approx(90 * 50 * 35 / 1000, rel=0.05)
    assert verdict.n_candies == seen.containability.verdict.n_candies, "only what was seen is counted on"


class Counting:
    """A pool that remembers what ran for which stage."""

    def __init__(self, pool):
        self.workers, self._pool, self.ran = pool.workers, pool, []

    def run(self, tasks, stage, reporter, found=None):
        self.ran += [(stage, len(tasks))]
        return self._pool.run(tasks, stage, reporter, found)


@pytest.mark.system
def test_what_may_leak_is_filled_beside_the_object_with_the_same_answer(dish, pipe, few, pool):
    hidden = CollisionModel.exact(dish.surface, UnseenReadings(40.0, dish.surface, pipe))

    def judged(runner):
        context = ImaginationContext(few, runner, Reporter())
        judge_ahead(context, hidden)
        return judge(context, hidden, imagine_drop(context, hidden)).verdict

    beside, in_turn = judged(counting := Counting(pool)), judged(RunHere())
    assert beside == in_turn and beside.is_undecided
    first = dict(reversed(counting.ran))
    # The drop, hollows of both, and those of half candies and of what was not seen; then fillings of both.
    assert first == {"containability": 5, "capacity": few.capacity.n_fillings + 1}


@pytest.mark.system
def test_hollows_are_found_beside_the_drop_with_the_same_answer(dish, few, pool):
    def judged(is_ahead: bool):
        context = ImaginationContext(few, counting := Counting(pool), Reporter())
        if is_ahead:
            judge_ahead(context, dish)
        judgement = judge(context, dish, imagine_drop(context, dish))
        return judgement, sum(n for stage, n in counting.ran if stage == "capacity")

    (ahead, n_ahead), (later, n_later) = judged(True), judged(False)
    assert ahead.verdict == later.verdict
    assert ahead.capacity.to_table() == later.capacity.to_table()
    assert n_later - n_ahead == 3, "those of candies, of the balls that stand for them, and of half candies"


def test_nothing_is_begun_ahead_that_no_answer_asks_for(dish, pipe, few, pool):
    by_omega = apply_settings(few, {"containability.verdict": "omega"})
    for parameters, runner in ((by_omega, pool), (few, RunHere())):
        context = ImaginationContext(parameters, runner, Reporter())
        judge_ahead(context, CollisionModel.exact(dish.surface, UnseenReadings(40.0, dish.surface, pipe)))
        assert not context.spare
    context = ImaginationContext(few, pool, Reporter())
    judge_ahead(context, CollisionModel.exact(dish.surface, UnseenReadings(40.0, dish.surface)))
    assert len(context.spare) == 3, "the hollows alone: no drop on what cannot leak"


def test_a_drop_that_was_made_ahead_is_that_of_its_surface_and_parameters(dish, dish_judged, few):
    ahead, drop = Ahead(), dish_judged.containability
    ahead.keep(dish.surface, few, drop)
    others = apply_settings(few, {"containability.contact.lateral_friction": 0.9})
    assert ahead.of(dish.surface, few) is drop
    assert ahead.of(dish.surface, others) is None
    assert ahead.of(dish.surface.translated([0.0, 0.0, 0.0]), few) is None


def test_a_gutter_is_none_though_candies_lie_heaped_in_it(few, pool):
    """Two walls on a floor, open at both ends: more than a tenth of its bulk stays, by friction alone."""
    sides = [box((-0.09, -0.033, 0), (0.09, -0.03, 0.03)), box((-0.09, 0.03, 0), (0.09, 0.033, 0.03))]
    gutter = CollisionModel.exact(join([box((-0.09, -0.033, -0.003), (0.09, 0.033, 0)), *sides]))
    found = imagine(gutter, few, pool, Reporter())
    verdict = found.containability.verdict
    assert found.capacity.bulk_ml > verdict.threshold * 180 * 66 * 33 / 1000
    assert verdict.capacity_share == 0 and not verdict.is_container and not verdict.is_undecided
    assert "with no closed rim around them" in verdict_sentence(found.containability)
    assert found.grid is None
