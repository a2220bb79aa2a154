import errno
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from core.errors import SessionError
from core.report import ReportContent, write_report
from core.report.page import render_page
from core.report.tables import object_facts, view_rows

VOID = {"meta", "img", "source", "br", "link"}


class Page(HTMLParser):
    """Collects the text, the addresses and the tags, and checks that the tags close in order."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.addresses: list[str] = []
        self.text = ""
        self.feed(html)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.addresses += [
            value or "" for name, value in attrs if name in ("src", "srcset", "href", "poster")
        ]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open[-1:] != ["style"]:
            self.text += " " + data.strip()


def read(content: ReportContent) -> Page:
    return Page(render_page(content))


def test_the_verdict_and_the_choice_come_first(full_content: ReportContent) -> None:
    text = read(full_content).text
    order = (
        "blue tray <3 & more",
        "Open container: 146 of 308",
        "Pour from 34°",
        "Note The views disagree",
        "Pictures",
        "The 24 pours at their end",
        "Pours",
        "Candies that land inside",
        "Object",
        "Agreement of the views",
        "no table seen",
        "Parameters",
        "reconstruction.voxel_m",
        "Times and versions",
        "pybullet 3.2.7",
    )
    text = re.sub(r"\s+", " ", text)
    places = [text.index(part) for part in order[:2]]
    for part in order[2:]:
        places.append(text.index(part, places[-1]))
    assert "20 November 2026, 14:03 UTC" in text


def test_the_model_is_shown_with_the_facts_of_the_object(full_content: ReportContent) -> None:
    page = read(full_content)
    seen = read(replace(full_content, model_pictures={"From behind": b"no picture"}))
    assert "From behind" not in page.text
    assert page.text.index("Object") < seen.text.index("From behind") < seen.text.index("Agreement")


def test_the_page_needs_nothing_else(full_content: ReportContent, tmp_path: Path) -> None:
    film = tmp_path / "drop.mp4"
    film.write_bytes(b"\x00\x00\x00\x18ftypmp42")
    page = read(replace(full_content, films={"The drop": film, "The chosen pour": b"mp4"}))
    assert page.tags.count("video") == 2 and "script" not in page.tags
    assert len(page.addresses) == 4 + 31 + 2
    assert all(address.startswith("data:") for address in page.addresses)


def test_everything_is_escaped(full_content: ReportContent) -> None:
    evil = '"><script>alert(1)</script>'
    html = render_page(
        replace(
            full_content,
            name=evil,
            created=evil,
            preset_name=evil,
            warnings=(evil,),
            pictures={evil: b"", evil + "2": next(iter(full_content.pictures.values()))},
            films={evil: b""},
            seconds={evil: 1.0},
            versions={evil: evil},
        )
    )
    assert "<script" not in html
    assert Page(html).text.count(evil) >= 8


def test_all_24_ratios_are_there(full_content: ReportContent) -> None:
    html = render_page(full_content)
    assert len(re.findall(r"<td[^>]*>\d+ ± \d+", html)) == 24
    assert html.count('class="tag"') == 1


def test_missing_parts_say_why(bare_content: ReportContent) -> None:
    page = read(bare_content)
    for sentence in (
        "There are no pictures of the imagination",
        "No pours were imagined because the object is not an open container.",
        "The mesh was imported, not scanned",
        "All parameters are those of the preset “default”.",
        "No times were recorded.",
        "some day",
    ):
        assert sentence in page.text
    assert page.addresses and "table" not in page.tags


def test_parameters_that_differ_are_listed_with_their_units(full_content: ReportContent) -> None:
    text = re.sub(r"\s+", " ", read(full_content).text)
    assert "3 differ from the preset “authors”" in text
    assert "reconstruction.voxel_m 0.003 m 0.004 m" in text
    assert "reconstruction.truncation_m automatic 0.02 m" in text


def test_a_lost_or_damaged_picture_does_not_spoil_the_report(
    full_content: ReportContent, tmp_path: Path
) -> None:
    text = read(
        replace(
            full_content,
            pictures={"lost": tmp_path / "lost.png", "damaged": b"no picture"},
            films={"gone": tmp_path / "gone.mp4"},
        )
    ).text
    assert "This picture cannot be shown: No such file or directory." in text
    assert "This picture cannot be shown: it is damaged." in text
    assert "This film cannot be shown: No such file or directory." in text


def test_object_that_is_not_closed(full_content: ReportContent) -> None:
    surface = full_content.surface
    opened = replace(surface, faces=surface.faces[1:])
    facts = object_facts(opened, None)
    assert facts["Volume"] == "unknown" and facts["Surface"].startswith("not closed")
    assert object_facts(surface, None) == {
        "Size (x, y, z)": "210 × 170 × 28 mm",
        "Volume": "1000 ml",
        "Surface": "closed (watertight), 12 faces",
    }


def test_heights_of_the_views_are_placed_on_one_scale(full_content: ReportContent) -> None:
    assert full_content.reconstruction is not None
    bars = [row.bar for row in view_rows(full_content.reconstruction)]
    assert bars[7] is None
    seen = np.array([bar for bar in bars if bar is not None])
    assert seen.min() == 0 and np.isclose(seen.max(), 100)


def test_the_file_is_written_whole_or_not_at_all(
    bare_content: ReportContent, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "report.html"
    write_report(bare_content, path)
    before = path.read_bytes()
    assert before.startswith(b"<!DOCTYPE html>")

    def fail(*_: object, **__: object) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_text", fail)
    with pytest.raises(SessionError, match="is full"):
        write_report(bare_content, path)
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == ["report.html"]


def test_loading_sessions_and_sentences_loads_no_plotting() -> None:
    import subprocess
    import sys

    code = (
        "import sys, core.session, core.report.sentences; "
        "print([name for name in ('matplotlib', 'jinja2', 'PIL', 'numba') if name in sys.modules])"
    )
    root = Path(__file__).resolve().parents[3]
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
