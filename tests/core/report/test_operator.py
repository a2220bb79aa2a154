"""What the report says of a pour that a person chose."""

from dataclasses import replace

import pytest

from core.imagination.results import PourChoice, PourGrid
from core.report import ReportContent, operator_sentence
from core.report.page import render_page
from core.session.operator_choice import OperatorChoice

OPERATOR = OperatorChoice(2, 1, "the handle is near.", "digest", "2026-11-21T10:00:00+00:00")


def test_it_names_both_pours_and_the_reason(pours: PourGrid, choice: PourChoice) -> None:
    assert operator_sentence(OPERATOR, pours, choice) == (
        "Chosen by the operator, from 124° at 31 mm: the handle is near "
        "(the program would choose 34° at 10 mm)."
    )
    same = replace(OPERATOR, i=choice.i, j=choice.j)
    assert operator_sentence(same, pours, choice).endswith("(the program would choose the same).")
    assert operator_sentence(OPERATOR, pours, None).endswith("(the program would choose none).")


@pytest.mark.parametrize("is_chosen", [True, False])
def test_the_report_tells_it(full_content: ReportContent, is_chosen: bool) -> None:
    content = replace(full_content, operator=OPERATOR if is_chosen else None)
    assert ("Chosen by the operator, from 124°" in render_page(content)) is is_chosen
