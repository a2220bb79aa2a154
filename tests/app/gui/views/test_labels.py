from pathlib import Path

import pytest

from app.gui.views.labels import place_text, view_number, with_view_numbers


@pytest.mark.parametrize(
    ("sentence", "said"),
    [
        ("View frame-000002 is left out: no depth.", "View 3 is left out: no depth."),
        ("frame-000001 repeats frame-000000.", "View 2 repeats View 1."),
        ("/scan/rgbd/frame-000001.depth.png is empty.", "/scan/rgbd/frame-000001.depth.png is empty."),
    ],
)
def test_views_are_called_by_their_numbers_files_by_their_names(sentence, said):
    assert with_view_numbers(sentence) == said


def test_a_view_without_a_number_keeps_its_name():
    assert (view_number("frame-000003"), view_number("frame-left")) == ("4", "frame-left")


def test_a_folder_is_named_from_the_home_folder_on(monkeypatch):
    monkeypatch.setenv("HOME", "/home/lab")
    assert place_text(Path("/home/lab/objects/cups")) == "~/objects/cups"
    assert place_text(Path("/data/objects")) == "/data/objects"
