"""The Scan page on the simulated cell with few views, so that a scan takes seconds."""

from __future__ import annotations

import pytest

N_VIEWS = 5


@pytest.fixture(scope="session")
def few_views():
    """The shipped simulated cell with its first views only."""
    from hardware.cell import read_cell

    cell = read_cell()
    return cell.model_copy(
        update={"scan": cell.scan.model_copy(update={"views_rad": cell.scan.views_rad[:N_VIEWS]})}
    )


@pytest.fixture
def sessions(monkeypatch, tmp_path):
    """Where the desk makes new sessions."""
    monkeypatch.setenv("POURSIGHT_SESSIONS", str(tmp_path / "sessions"))
    return tmp_path / "sessions"


@pytest.fixture
def make_page(qtbot, desk):
    """Make a shown page on a cell; `settle` waits until it has read everything."""
    from app.gui.pages.scan.page import ScanPage

    def make(cell):
        page = ScanPage(desk)
        qtbot.addWidget(page)
        page.resize(1040, 640)
        page.show()
        desk.cell.settings = cell
        desk.cell.changed.emit()
        settle(qtbot, desk, page)
        return page

    return make


def settle(qtbot, desk, page):
    """Wait until nothing is under way and the page knows what the session holds."""
    qtbot.waitUntil(lambda: desk.jobs.is_idle and desk.background.is_idle)
    qtbot.waitUntil(lambda: page.content is not None and page.side.choice._combo.count() > 2)


@pytest.fixture
def small_cell_page(make_page, few_views, sessions):
    return make_page(few_views)
