"""What was found of one object in one trial: the row of every table. Light: no physics here."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from typing_extensions import override

from core.evaluation.labels import Label

FIRST_WORLD = "bullet"
"""The ground-truth world of evaluations that had only one."""
Measure = Literal["Capacity share", "Omega", "Appearance score"]
"""What is held against the threshold."""


class Scored:
    """What is judged by a score: the base of whatever keeps the counts of a drop and the capacity share.

    Attributes:
        n_drop: candies dropped; 0 if it could not be judged.
        n_in: candies that stayed.
        capacity_share: volume it holds as a share of its convex hull's; none if it was judged by Omega.
    """

    n_drop: int
    n_in: int
    capacity_share: float | None

    @property
    def omega(self) -> float | None:
        """Omega (Eq. 1); none if nothing was dropped."""
        return self.n_in / self.n_drop if self.n_drop else None

    @property
    def measure(self) -> Measure:
        """What judges it."""
        return "Omega" if self.capacity_share is None else "Capacity share"

    @property
    def score(self) -> float | None:
        """The capacity share or Omega, whichever judges it; none if the object could not be judged."""
        return self.omega if self.capacity_share is None else self.capacity_share


@dataclass(frozen=True)
class Trial(Scored):
    """One object, judged once by one variant and, if it is judged a container, poured into.

    Attributes:
        name: the object's.
        label: what a person calls it.
        seed: of the scan's placing and noise, of the candies and of the ground-truth simulation.
        variant: a name of `core.evaluation.variants`.
        threshold: of what judged: a capacity share, or Omega_thr.
        n_drop: N_drop; 0 if it could not be judged.
        n_in: N_in.
        capacity_share: volume it holds as a share of its convex hull's; none if it was judged by Omega.
        capacity_candies: candies it holds level with its rim; none if not imagined.
        capacity_ml: bulk volume of these; none if not imagined.
        capacity_least_ml: what `capacity_ml` truly is at least, as the program says; none if it says nothing.
        capacity_most_ml: and at most; none likewise, and where part of the inside was not seen.
        unseen_ml: volume inside that no view saw, on which the answer depends; none where it does not.
        holds_rad: tilt up to which nothing leaves, in the worst direction; none if not imagined.
        p_chosen: P of the chosen pour (Eq. 4); none if it is no container.
        clean_at_least: chance that it spills nothing, the lower 95 % bound; none without tries.
        wanted_clean: the bound below which pouring is not advised; none where nothing is advised.
        n_tries: imagined pours in all, with and without errors; 0 without a risk.
        n_feasible: how many of the imagined pours the arm can make; none without an arm.
        choice: (i, j) of the chosen pour.
        theta_rad: direction of the chosen pour, against the base frame's x-axis.
        n_pour: candies in the cup.
        worlds: the ground-truth world of each pour.
        spilled: candies spilled, for each pour; empty if there was none.
        in_cup: candies that stayed in the cup, for each pour.
        view_scores: of each view that shows the object, by name: how surely the network takes it for an open
            container (Sec. V-A); empty where physics judges.
        view: which of them counts; none where physics judges.
        top_down: the one that looks most steeply down, from which pours are found.
        is_restricted: whether the object belongs to the restricted set (Sec. IV-B).
        seconds: by stage; what several variants share is counted for the first of them.
        picture: name of the picture's file, or empty.
        problem: why it could not be judged, in a sentence; empty if it could.
    """

    name: str
    label: Label
    seed: int
    variant: str
    threshold: float
    n_drop: int = 0
    n_in: int = 0
    capacity_share: float | None = None
    capacity_candies: float | None = None
    capacity_ml: float | None = None
    capacity_least_ml: float | None = None
    capacity_most_ml: float | None = None
    unseen_ml: float | None = None
    holds_rad: float | None = None
    p_chosen: float | None = None
    clean_at_least: float | None = None
    wanted_clean: float | None = None
    n_tries: int = 0
    n_feasible: int | None = None
    choice: tuple[int, int] | None = None
    theta_rad: float | None = None
    n_pour: int = 0
    worlds: tuple[str, ...] = ()
    spilled: tuple[int, ...] = ()
    in_cup: tuple[int, ...] = ()
    view_scores: Mapping[str, float] = field(default_factory=dict)
    view: str | None = None
    top_down: str | None = None
    is_restricted: bool = False
    seconds: Mapping[str, float] = field(default_factory=dict)
    picture: str = ""
    problem: str = ""

    @property
    @override
    def measure(self) -> Measure:
        return "Appearance score" if self.view is not None else super().measure

    @property
    @override
    def score(self) -> float | None:
        return self.view_scores.get(self.view) if self.view is not None else super().score

    @property
    def is_judged_container(self) -> bool | None:
        """Whether the score exceeds its threshold; none if the object could not be judged."""
        return None if self.score is None or self.is_undecided else self.score > self.threshold

    @property
    def predicted(self) -> str:
        """What it was judged, in the words of the labels; empty if it could not be judged."""
        if self.is_undecided:
            return "cannot tell"
        return {True: "container", False: "non-container", None: ""}[self.is_judged_container]

    @property
    def is_right(self) -> bool | None:
        """Whether judgement and label agree; none for an ambiguous object. What failed is not right."""
        if self.label == "ambiguous":
            return None
        return self.is_judged_container == (self.label == "container")

    @property
    def is_undecided(self) -> bool:
        """Whether the program said that it cannot tell; that is never right."""
        return self.unseen_ml is not None

    @property
    def n_pours(self) -> int:
        """Pours made in the ground-truth simulation."""
        return len(self.spilled)

    @property
    def n_clean_pours(self) -> int:
        """Pours of which no candy was spilled, the paper's success (Sec. V-B)."""
        return sum(count == 0 for count in self.spilled)

    @property
    def is_declined(self) -> bool:
        """Whether the program advised not to pour; it was poured all the same, to see who is right."""
        if self.clean_at_least is None or self.wanted_clean is None:
            return False
        return self.clean_at_least < self.wanted_clean

    @property
    def is_rightly_declined(self) -> bool:
        """Whether it was, and fewer of its pours were clean than wanted."""
        return self.is_declined and self.n_clean_pours < (self.wanted_clean or 0.0) * self.n_pours

    @property
    def total_s(self) -> float:
        """All seconds."""
        return sum(self.seconds.values())

    def to_table(self) -> dict[str, Any]:
        """Return it as plain JSON."""
        return asdict(self) | {"seconds": dict(self.seconds), "view_scores": dict(self.view_scores)}

    @classmethod
    def from_table(cls, table: Mapping[str, Any]) -> Trial:
        """Read what `to_table` gave, once it is what `core.formats` says."""
        values = dict(table)
        choice = values.get("choice")
        values["choice"] = None if choice is None else tuple(choice)
        values.setdefault("worlds", [FIRST_WORLD] * len(values.get("spilled", ())))
        values |= {name: tuple(values.get(name, ())) for name in ("worlds", "spilled", "in_cup")}
        return cls(**values)


def measure_of(trials: Iterable[Trial]) -> Measure:
    """Return what judges the trials of one variant; those that failed do not show it."""
    found = {one.measure for one in trials} - {"Omega"}
    return found.pop() if found else "Omega"


def measure_word(measure: Measure) -> str:
    """Return a measure as it is written within a sentence."""
    return measure if measure == "Omega" else measure.lower()
