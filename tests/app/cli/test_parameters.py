"""Parameters on the command line: all are listed, and presets that people saved are found by their names."""

from pathlib import Path

import pytest

from app.cli.parameters import Choices, parameters_page
from app.library.places import named_preset, preset_file
from core.errors import InputError
from core.files import write_json
from core.parameters import Parameters, flatten

PAGE = Path(__file__).resolve().parents[3] / "docs" / "parameters.md"


def test_the_page_in_the_documentation_is_up_to_date():
    assert PAGE.read_text(encoding="utf-8") == parameters_page(), (
        "make it anew: poursight parameters --markdown > docs/parameters.md"
    )


def test_every_parameter_is_listed(poursight):
    code, out, _ = poursight("parameters", "--preset", "paper")
    assert code == 0
    for name in flatten(Parameters()):
        assert name in out


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))


@pytest.mark.usefixtures("home")
def test_a_saved_preset_is_found_by_its_name(tmp_path):
    write_json(preset_file("Slow hands"), {"parameters": {"containability.omega_threshold": 0.2}})
    name, parameters = Choices("Slow hands", [], None).parameters(tmp_path / "session")
    assert parameters.containability.omega_threshold == 0.2
    assert Path(name).is_file()


@pytest.mark.usefixtures("home")
def test_shipped_presets_and_files_keep_their_names(tmp_path):
    file = tmp_path / "mine.json"
    write_json(file, {"parameters": {}})
    assert named_preset("paper") == "paper"
    assert named_preset(str(file)) == str(file)
    with pytest.raises(InputError, match="no preset 'papr'; did you mean 'paper'"):
        Choices("papr", [], None).parameters(tmp_path / "session")
