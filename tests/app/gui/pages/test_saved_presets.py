import pytest

from app.gui.pages.saved_presets import preset_names, save_preset
from core.errors import SessionError
from core.parameters import PRESET_NAMES, Parameters, apply_settings, load_preset

CHANGED = apply_settings(Parameters(), {"containability.n_max": 100, "reconstruction.voxel_m": 0.003})


@pytest.fixture(autouse=True)
def _forgotten(qapp, forgetful):
    """Presets of other tests are not remembered."""


def test_a_saved_preset_is_what_the_command_line_reads(tmp_path):
    save_preset(tmp_path / "mine.json", CHANGED)
    assert load_preset(str(tmp_path / "mine.json")) == CHANGED


def test_saved_presets_are_offered_until_their_file_goes(tmp_path):
    assert preset_names() == list(PRESET_NAMES)
    for name in ("one", "two"):
        save_preset(tmp_path / f"{name}.json", CHANGED)
        saved = preset_names()[len(PRESET_NAMES) :]
        assert saved[0] == str(tmp_path / f"{name}.json")
    (tmp_path / "two.json").unlink()
    assert preset_names() == [*PRESET_NAMES, str(tmp_path / "one.json")]


def test_a_preset_that_cannot_be_written_is_explained_and_not_offered(tmp_path):
    with pytest.raises(SessionError, match=r"mine\.json cannot be written.*another folder"):
        save_preset(tmp_path / "nowhere" / "mine.json", CHANGED)
    assert preset_names() == list(PRESET_NAMES)
