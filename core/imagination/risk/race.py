"""Where the next tries are spent: always on the pour that promises most, until one is sure or all are spent.

A pour that spills falls behind and is given up; one that stays clean is tried until its lower bound is
reached. Most objects need the tries of one pour, and a difficult one gets all there are.
"""

from __future__ import annotations

from collections.abc import Sequence

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
        """Tries that there may be."""
        return self._settings.n_tries

    @property
    def risk(self) -> PourRisk:
        """What is known by now."""
        return PourRisk(self._n_pour, joined(self.tried), self._n_cups)

    def next_round(self) -> tuple[tuple[int, int], range] | None:
        """Return the pour to try next and the numbers of its tries; none if the race is over."""
        if not self._order:
            return None
        risk = self.risk
        i, j = self._most_promising(risk)
        n_tries = min(ROUND, self._settings.n_tries - self._spent)
        if n_tries <= 0 or risk.clean_at_least[i, j] >= self._settings.sure:
            return None
        done = len(self.tried[i][j])
        return (i, j), range(done, done + n_tries)

    def record(self, pour: tuple[int, int], spilled: Sequence[int]) -> None:
        """Take the tries of the last round."""
        self.tried[pour[0]][pour[1]] += list(spilled)
        self._spent += len(spilled)

    def _most_promising(self, risk: PourRisk) -> tuple[int, int]:
        expected, mean = risk.expected_clean, risk.mean_spilled
        return min(self._order, key=lambda pour: (-expected[pour], mean[pour], self._order[pour]))
