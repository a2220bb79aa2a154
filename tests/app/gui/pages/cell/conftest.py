"""The Cell page, shown, with cells of its own."""

from __future__ import annotations

import pytest

from app.gui.pages.cell.page import CellPage
from tests.app.gui.pages.cell.acting import settle


@pytest.fixture
def cells(tmp_path, monkeypatch):
    monkeypatch.setenv("POURSIGHT_CELLS", str(tmp_path / "cells"))
    return tmp_path / "cells"


@pytest.fixture
def page(qtbot, desk, cells):
    page = CellPage(desk)
    qtbot.addWidget(page)
    page.resize(1040, 640)
    page.show()
    desk.cell.choose(None)
    settle(qtbot, desk, page)
    return page
