from pathlib import Path

from app.listing import parameters_page
from core.parameters import Parameters, flatten

PAGE = Path(__file__).resolve().parents[2] / "docs" / "parameters.md"


def test_the_page_in_the_documentation_is_up_to_date():
    assert PAGE.read_text(encoding="utf-8") == parameters_page(), (
        "make it anew: poursight parameters --markdown > docs/parameters.md"
    )


def test_every_parameter_is_listed(poursight):
    code, out, _ = poursight("parameters", "--preset", "paper")
    assert code == 0
    for name in flatten(Parameters()):
        assert name in out
