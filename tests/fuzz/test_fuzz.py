"""A small share of `make fuzz`: damaged input is read, or refused in a sentence."""

from __future__ import annotations

import pytest

from tests.fuzz.fuzzing import Tally, prepared, try_input
from tests.fuzz.targets import TARGETS

N_INPUTS = 20
FAILED_ONCE = {"session": (367, 382), "path": (65,), "set": (39, 49)}


@pytest.mark.parametrize("target", list(TARGETS))
def test_damaged_input_is_read_or_refused_in_a_sentence(target, tmp_path):
    base, tally = prepared(target, tmp_path), Tally()
    for seed in (*range(N_INPUTS), *FAILED_ONCE.get(target, ())):
        try_input(target, seed, base, tally)
    assert not tally.failures, "\n".join(tally.failures)
    assert tally.calls[target, "refused"] > 0
