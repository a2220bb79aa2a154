"""Where the next tries are spent: always on the pour that promises most, until one is sure or all are spent.

A pour that spills falls behind and is given up; one that stays clean is tried until its lower bound is
reached. Most objects need the tries of one pour, and a difficult one gets all there are. Where none of its
pours is as sure as is wanted then, but the surest seems to be, that one is tried as often again: of pours
that are clean in 80 % one in five would be advised against for want of tries (docs/decisions/0054).
"""

from __future__ import annotations

from collections.abc import Sequence

from core.imagination.choice import surest_first
from core.imagination.risk.result import NOT_TRIED, PourRisk, joined
from core.parameters.risk import RiskParameters

ROUND = 4
"""Tries at a time: a fixed number, so that the result does not depend on the number of workers."""


class Race:
    """The state of the tries of all pours; knows no physics.

    Attributes:
        tried: [i][j] spilled candies of each try so far.
    """

    def __init__(self, known: PourRisk, order: Sequence[tuple[int, int]], settings: RiskParameters) -> None:
        """Begin with what is known; the pours in `order` compete, of equals the first is preferred."""
        self._n_pour, self._n_cups = known.n_pour, known.n_cups
        self._settings = settings
        self._order = {pour: rank for rank, pour in enumerate(order)}
        self._spent = 0
        self.tried: list[list[list[int]]] = [
            [[n for n in pour if n != NOT_TRIED] for pour in row] for row in known.spilled.tolist()
        ]

    @property
    def n_spent(self) -> int:
        """Tries so far."""
        return self._spent

    @property
    def n_most(self) -> int:
        """Tries among all pours that there may be, before those of the surest alone."""
        return self._settings.n_tries

    @property
    def risk(self) -> PourRisk:
        """What is known by now."""
        return PourRisk(self._n_pour, joined(self.tried), self._n_cups)

    def next_round(self) -> tuple[tuple[int, int], range] | None:
        """Return the pour to try next and the numbers of its tries; none if the race is over."""
        if not self._order:
            return None
        risk, settings = self.risk, self._settings
        if self._spent < settings.n_tries:
            pour, left = self._most_promising(risk), settings.n_tries - self._spent
            enough = settings.sure_enough
        else:
            pour, left = surest_first(risk, [*self._order])[0], 2 * settings.n_tries - self._spent
            enough = settings.wanted_clean
            if risk.n_tries[pour] <= ROUND or risk.expected_clean[pour] < enough:
                return None
        if left <= 0 or risk.clean_at_least[pour] >= enough:
            return None
        done = len(self.tried[pour[0]][pour[1]])
        return pour, range(done, done + min(ROUND, left))

    def record(self, pour: tuple[int, int], spilled: Sequence[int]) -> None:
        """Take the tries of the last round."""
        self.tried[pour[0]][pour[1]] += list(spilled)
        self._spent += len(spilled)

    def _most_promising(self, risk: PourRisk) -> tuple[int, int]:
        expected, mean = risk.expected_clean, risk.mean_spilled
        return min(self._order, key=lambda pour: (-expected[pour], mean[pour], self._order[pour]))
