"""The report on paper: laid out as `pdf_job` does it, nothing is clipped, squeezed or torn apart."""

from __future__ import annotations

import re

import numpy as np
import pytest
from PIL import ImageFile

from core.motion.pour.feasibility import PourFeasibility, PourMotions
from core.parameters import apply_settings, flatten, load_preset
from core.reconstruction.pose_health import PoseHealth, ViewHealth
from core.reconstruction.result import Reconstruction
from core.report import ReportContent
from core.report.page import render_page
from core.session.pour_runs import PourRun

SETTINGS = {"pouring.n_pour": 40, "particle.diameter_m": 0.008, "seed": 3}


@pytest.fixture(scope="module")
def page(results):
    pours = tuple(
        PourFeasibility(i, j, i != 1, "In the move 'lay' the hand would leave the arm's reach.", 0.02, 2, 20)
        for i in (0, 1)
        for j in range(3)
    )
    events = ({"time": "2026-11-21T11:09:44+00:00", "kind": "stopped", "sentence": "The robot stopped."},)
    views = tuple(ViewHealth(f"frame-{k:06d}", 0.015 + 0.0001 * k, 0.01) for k in range(24))
    preset = load_preset("default")
    picture = results.png((640, 480), (200, 200, 200))
    names = ("Start", "Falling", "Settled", "Rotated", "Pushed", "End")
    content = ReportContent(
        name="a-session-with-a-name-that-is-longer-than-anybody-would-like-it-to-be-on-a-page" * 2,
        created="2026-11-20T14:03:22+00:00",
        preset_name="default",
        preset=preset,
        parameters=apply_settings(preset, SETTINGS),
        containability=results.drop(40).judged(0.0, None),
        surface=results.box_mesh(),
        reconstruction=Reconstruction(results.box_mesh(), 0.0, 0.009, PoseHealth(views)),
        pours=results.pours(),
        choice=results.choice(0, 1),
        scan_pictures={f"frame-{k:06d}": results.png((240, 180), (9, 9, 9)) for k in range(24)},
        pictures=dict.fromkeys(names, picture)
        | {"The pours at their end": results.png((1962, 1168), (1, 1, 1))},
        films={"The drop and the perturbations": b"film", "The chosen pour": b"film"},
        seconds={"reconstruction": 3.0, "pouring": 17.5},
        versions={"python": "3.11.7"},
        warnings=("The views disagree by 3.0 mm: calibrate the camera, or scan again.",) * 4,
        motions=PourMotions(pours, results.choice(0, 1), results.choice(0, 1), None),
        runs=tuple(PourRun(None, events, None) for _ in range(30)),
    )
    return render_page(content)


@pytest.fixture(scope="module")
def pages(page):
    import weasyprint

    # WeasyPrint makes Pillow take cut-off pictures for whole ones; other tests damage theirs.
    ImageFile.LOAD_TRUNCATED_IMAGES = False
    return [sheet._page_box for sheet in weasyprint.HTML(string=page).render().pages]


def boxes(sheet, tag=None, of_class=None):
    for box in sheet.descendants():
        element = box.element
        if element is None or (tag is not None and box.element_tag != tag):
            continue
        if of_class is None or of_class in element.get("class", "").split():
            yield box


def test_the_page_needs_nothing_else(page):
    sources = re.findall(r"""(?:src|srcset|href|data)=["']([^"']{0,40})""", page)
    assert len(sources) > 30
    assert all(source.startswith("data:") for source in sources)
    assert "url(" not in page and "@import" not in page


def test_nothing_reaches_beyond_the_margins(pages):
    for sheet in pages:
        right = sheet.content_box_x() + sheet.width
        for box in boxes(sheet):
            if (
                box.element_tag in ("p", "td", "th", "img", "figcaption", "h1", "li", "dd")
                and box.width != "auto"
            ):
                assert box.position_x + box.width <= right + 1, (box, box.element.text)


def test_pictures_stand_three_abreast_and_the_wide_one_alone(pages):
    images = [box for sheet in pages for box in boxes(sheet, "img")]
    widths = np.array([box.width for box in images])
    sheet_width = pages[0].width
    stills = [w for w in widths if 0.28 * sheet_width < w < 0.34 * sheet_width]
    assert len(stills) == 6
    assert sum(w > 0.95 * sheet_width for w in widths) == 1
    assert sum(0.09 * sheet_width < w < 0.13 * sheet_width for w in widths) == 24
    assert len(images) == 6 + 1 + 24 + 2  # and the two plots


def test_tables_of_pours_are_not_torn_apart(pages):
    n_tables = [len({box.element for box in boxes(sheet, "table", "numbers")}) for sheet in pages]
    assert sum(n_tables) == 2


def test_long_tables_repeat_their_head(pages):
    heads = [list(boxes(sheet, "thead")) for sheet in pages if list(boxes(sheet, "table", "runs"))]
    assert len(heads) > 1 and all(heads)


def test_no_heading_ends_a_page(pages):
    for sheet in pages[:-1]:
        placed = [
            box for box in boxes(sheet) if box.element_tag in ("h2", "h3", "p", "td", "img", "li", "dd", "dt")
        ]
        last = max(placed, key=lambda box: box.position_y)
        assert last.element_tag not in ("h2", "h3", "dt")


def test_films_are_named_on_paper(page, pages):
    text = "".join(box.text for sheet in pages for box in sheet.descendants() if hasattr(box, "text"))
    assert "Films, to be seen in the report on a screen: The drop and the perturbations" in text
    assert "The chosen pour" in text
    assert all(name in flatten(load_preset("default")) and name in page for name in SETTINGS)
