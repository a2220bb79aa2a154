"""How an evaluation of objects made by code went, family by family.

Usage: python -m tests.benchmarks.families OUT
"""

from __future__ import annotations

import sys
from pathlib import Path

from core.evaluation.evaluation import Evaluation
from core.evaluation.tables import text_table


def print_families(folder: Path) -> None:
    """Print how many of each family were judged rightly, its ambiguous members apart, and what was wrong."""
    evaluation = Evaluation.load(folder)
    family_of = {one.name: one.category for one in evaluation.objects}
    trials = evaluation.of_variant(evaluation.variants[0])
    rows = []
    for family in dict.fromkeys(family_of.values()):
        own = [one for one in trials if family_of[one.name] == family]
        right = [one.is_right for one in own if one.is_right is not None]
        open_ones = [one.is_judged_container for one in own if one.is_right is None]
        rows.append(
            (family, f"{sum(right)} of {len(right)}", f"{sum(map(bool, open_ones))} of {len(open_ones)}")
        )
    print(text_table(("family", "judged right", "ambiguous judged containers"), rows, n_words=1))
    for one in trials:
        if one.is_right is False:
            print(f"{one.name}: {one.label}, judged {one.predicted or one.problem} ({one.score})")


if __name__ == "__main__":
    print_families(Path(sys.argv[1]))
