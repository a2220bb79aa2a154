"""Presets that people saved are found by their names."""

from pathlib import Path

import pytest

from app.commands import Choices
from app.presets import named_preset, preset_file
from core.errors import InputError
from core.files import write_json


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))


def test_a_saved_preset_is_found_by_its_name(tmp_path: Path) -> None:
    write_json(preset_file("Slow hands"), {"parameters": {"containability.omega_threshold": 0.2}})
    name, parameters = Choices("Slow hands", [], None).parameters(tmp_path / "session")
    assert parameters.containability.omega_threshold == 0.2
    assert Path(name).is_file()


def test_shipped_presets_and_files_keep_their_names(tmp_path: Path) -> None:
    file = tmp_path / "mine.json"
    write_json(file, {"parameters": {}})
    assert named_preset("paper") == "paper"
    assert named_preset(str(file)) == str(file)
    with pytest.raises(InputError, match="no preset 'papr'; did you mean 'paper'"):
        Choices("papr", [], None).parameters(tmp_path / "session")
