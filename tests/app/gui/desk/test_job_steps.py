import pytest

from app.gui.desk.job_steps import TYPICAL_S, JobSteps
from app.gui.desk.workspace import IMAGINING, Workspace

NAMES = ("containability", "capacity", "pouring", "risk")


class Clock:
    def __init__(self):
        self.now_s = 100.0

    def __call__(self):
        return self.now_s


@pytest.fixture
def clock():
    return Clock()


def run_through(steps, clock, slowness):
    """Each step takes its usual time times a factor; return the fractions and times left that were said."""
    fractions, left_s = [], []
    for name in steps.names:
        for share in (0.0, 0.25, 0.5, 0.75, 1.0):
            steps.progress(name, share)
            fractions.append(steps.fraction)
            left_s.append(steps.seconds_left)
            clock.now_s += 0.25 * slowness(name) * TYPICAL_S[name]
    return fractions, [said_s for said_s in left_s if said_s is not None]


@pytest.mark.parametrize(
    "slowness",
    [
        lambda _: 1.0,
        lambda _: 5.0,
        lambda _: 0.1,
        lambda name: 6.0 if name == "pouring" else 0.5,
        lambda name: 0.2 if name == "pouring" else 3.0,
    ],
    ids=["as usual", "slow", "fast", "slow in the middle", "fast in the middle"],
)
def test_whatever_the_pace_neither_figure_goes_back(clock, slowness):
    fractions, left_s = run_through(JobSteps(NAMES, clock), clock, slowness)
    assert fractions == sorted(fractions)
    assert fractions[0] == 0.0
    assert fractions[-1] == pytest.approx(1.0)
    assert left_s == sorted(left_s, reverse=True)
    assert left_s[-1] == pytest.approx(0.0)


def test_at_its_usual_pace_the_time_left_is_true(clock):
    steps = JobSteps(NAMES, clock)
    assert steps.seconds_left is None  # nothing is known of its pace
    assert not steps.is_late
    clock.now_s += TYPICAL_S["containability"] + TYPICAL_S["capacity"]
    steps.progress("pouring", 0.0)
    assert steps.seconds_left == pytest.approx(TYPICAL_S["pouring"] + TYPICAL_S["risk"])


def test_progress_of_a_step_that_is_over_or_unknown_changes_nothing(clock):
    steps = JobSteps(NAMES, clock)
    steps.progress("risk", 0.5)
    before = steps.fraction
    for name in ("pouring", "cup", "containability"):
        steps.progress(name, 0.1)
    steps.progress("risk", 0.2)
    assert (steps.current, steps.fraction) == ("risk", before)


def test_a_job_far_slower_than_was_said_says_so_and_not_a_time_that_grows(clock):
    steps = JobSteps(NAMES, clock)
    clock.now_s += 3
    steps.progress("capacity", 0.0)
    assert steps.seconds_left is not None
    clock.now_s += 300
    assert steps.seconds_left is None
    assert steps.is_late


def test_what_is_stale_are_the_steps(qapp, mug_session, tmp_path):
    workspace = Workspace()
    workspace.open(tmp_path / "new")
    assert workspace.steps_to(*IMAGINING)[0] == "reconstruction"
    workspace.open(mug_session)
    assert workspace.steps_to("risk") == ()
    assert workspace.steps_to(*IMAGINING) == ("colors",)
    (mug_session / "judgement" / "record.json").unlink()
    workspace.refresh()
    assert workspace.steps_to("risk") == ("capacity", "pouring", "risk"), "neither waits for the tilting"
    (mug_session / "retention" / "record.json").unlink()
    workspace.refresh()
    assert workspace.steps_to(*IMAGINING)[-1] == "retention"
