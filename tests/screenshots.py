"""Pictures of every page, light and dark, small and large, with a container and with something that is none.

Run by `make screenshots`: the sessions are made by the real pipeline, in a real window on a virtual screen.
All are kept in the folder given; `docs/screenshots` gets those that the documents show, and holds no others.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
from pathlib import Path

from PIL import Image
from PySide6.QtCore import QSettings
from PySide6.QtWidgets import QComboBox, QPushButton, QSpinBox, QWidget

from app.gui.headless_check import Walk, let_work
from app.gui.main import make_application, open_window
from app.gui.pages.history.page import HistoryPage
from app.gui.pages.page import PRIMARY
from app.gui.pages.registry import OTHERS, WORK
from app.gui.pages.tuning.page import TuningPage
from app.gui.pages.welcome.pictures import FOLDER, PIXEL_RATIO, SIZE_PX
from app.library.places import SESSIONS_VARIABLE
from app.operations.calibration.cell_file import CELLS_VARIABLE, known_cells, new_cell
from app.operations.calibration.check import check_cell
from app.operations.calibration.cup import enter_cup
from app.operations.calibration.cup_entry import entry_of
from app.operations.calibration.devices import examine_device
from app.operations.calibration.dry_run import dry_run
from app.operations.calibration.hand_eye import calibrate_cell
from app.operations.calibration.reference import store_reference
from app.operations.calibration.steps import enter_board, steps
from app.operations.calibration.table import measure_table
from app.operations.calibration.touch import read_touch
from app.operations.calibration.views import choose_views
from core.calibration.board import BoardSpec
from core.mesh_file import write_mesh
from core.parameters import Parameters, apply_settings
from core.progress import Reporter
from core.resources import RESOURCES
from hardware.cell import read_cell
from hardware.simulation.objects import builtin_object
from tests.app.sessions import make_poured_session, make_session
from tests.patience import HANG_S

SIZES = ((1280, 800), (1920, 1080))
THEMES = ("light", "dark")
OBJECTS = {"mug": make_poured_session, "block": make_session}
LABELS = {
    "mug": "container",
    "bowl": "container",
    "glass": "container",
    "plate": "ambiguous",
    "ring": "non-container",
    "block": "non-container",
}
_QUICK_FIT = {
    "containability.verdict": "omega",
    "containability.n_max": 40,
    "containability.n_min": 20,
    "containability.contact.rolling_friction": 0.3,  # candies stick where they fall, until it is fitted
    "containability.contact.lateral_friction": 0.6,
}
_STEP_BOXES = {
    "scan": (250, 130, 730, 490),
    "reconstruction": (176, 182, 868, 701),
    "imagination": (330, 240, 730, 540),
    "pours": (490, 195, 890, 495),
}
"""Of the 3D view on each page, in the smaller window's pixels."""
_SETTLING_S = 1.2
_ROOT = RESOURCES.parent
_SHOWN = re.compile(r"screenshots/([\w-]+\.png)")


def main() -> None:
    """Write `<object>-<page>-<theme>-<width>.png` into the folder given."""
    target = Path(sys.argv[1])
    target.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as home:
        for variable in ("HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME"):
            os.environ[variable] = home
        library = Path(home) / "sessions"
        os.environ[SESSIONS_VARIABLE] = str(library)
        for name, make in OBJECTS.items():
            make(library / name, name)
            print(f"session '{name}' made", flush=True)
        os.environ[CELLS_VARIABLE] = str(Path(home) / "cells")
        _make_cell()
        _make_objects(library.parent / "objects")
        make_application()
        for theme in THEMES:
            for size in SIZES:
                _picture(target, library, theme, size)
            _crop_steps(target, theme)
    keep_what_is_shown(target)


def keep_what_is_shown(made: Path) -> None:
    """Copy the pictures that the documents show; a repository need not carry the others."""
    documents = (_ROOT / "README.md", *(_ROOT / "docs").glob("*.md"))
    names = {name for one in documents for name in _SHOWN.findall(one.read_text(encoding="utf-8"))}
    folder = _ROOT / "docs" / "screenshots"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    for name in sorted(names):
        shutil.copy(made / name, folder / name)
    print(f"{len(names)} pictures, {sum(one.stat().st_size for one in folder.iterdir()) / 1e6:.1f} MB")


def _picture(target: Path, library: Path, theme: str, size: tuple[int, int]) -> None:
    """All pages of all sessions in one window."""
    application = make_application()
    QSettings().setValue("theme", theme)
    window = open_window(application)
    window.resize(*size)
    walk = Walk(window)
    ready: list[bool] = []
    window.ready.connect(lambda: ready.append(True))
    walk.wait(lambda: ready, "the window is ready", HANG_S)
    _keep(walk, target / f"welcome-{theme}-{size[0]}.png")
    _picture_cell(walk, target, f"{theme}-{size[0]}")
    for name in OBJECTS:
        window.desk.open_session(library / name)
        for key in (key for key in (*WORK, *OTHERS) if key != "cell"):
            window.show_page(key)
            if key == "tuning":
                _judge(walk, library.parent / "objects")
                _fit(walk, target / f"{name}-fit-{theme}-{size[0]}.png")
            if key == "robot" and window.desk.workspace.is_container:
                _plan(walk)
            _keep(walk, target / f"{name}-{key}-{theme}-{size[0]}.png")
            if key == "history":
                _compare(walk, library, target / f"{name}-comparison-{theme}-{size[0]}.png")
        window.desk.workspace.close()
    window.close_without_asking()


def _crop_steps(target: Path, theme: str) -> None:
    """The pictures of the first page, cut out of those of the other pages."""
    width, height = (PIXEL_RATIO * edge for edge in SIZE_PX)
    FOLDER.mkdir(exist_ok=True)
    for step, box in _STEP_BOXES.items():
        with Image.open(target / f"mug-{step}-{theme}-{SIZES[0][0]}.png") as picture:
            picture.resize((width, height), Image.Resampling.LANCZOS, box).save(
                FOLDER / f"{step}-{theme}.png", optimize=True
            )


def _make_cell() -> None:
    """A simulated cell with all its steps done."""
    path = new_cell("bench", is_simulated=True)
    for step in ("arm", "camera"):
        examine_device(path, step)
    enter_board(path, BoardSpec(), "a4", 0.030)
    calibrate_cell(path, Reporter(), None)
    check_cell(path, Reporter(), None, lambda: None)
    for _ in range(3):
        read_touch(path)
    measure_table(path, Reporter(), None, lambda: None)
    choose_views(path, Reporter())
    store_reference(path, Reporter(), None, lambda: None)
    enter_cup(path, entry_of(read_cell(path)), Reporter())
    dry_run(path, Reporter(), None)


def _picture_cell(walk: Walk, target: Path, how: str) -> None:
    """The Cell page, which depends on no session: all steps done, and each of them chosen."""
    cell = walk.window.desk.cell
    cell.choose(known_cells()[0])
    walk.window.show_page("cell")
    walk.wait(lambda: cell.path is not None, "the cell is read", HANG_S)
    _keep(walk, target / f"cell-{how}.png")
    for step in steps(known_cells()[0]):
        walk.click(f"step_{step.name}")
        _keep(walk, target / f"cell-{step.name}-{how}.png")
    cell.choose(None)
    walk.wait(lambda: cell.path is None, "the shipped cell is read", HANG_S)


def _make_objects(folder: Path) -> None:
    """Built-in objects with their labels, for the Tune page."""
    folder.mkdir()
    for name in LABELS:
        write_mesh(folder / f"{name}.obj", builtin_object(name))
    rows = "\n".join(f"{name},{label}" for name, label in LABELS.items())
    (folder / "labels.csv").write_text(f"id,label\n{rows}\n")


def _plan(walk: Walk) -> None:
    """Connect the simulated arm and plan, so that there is something to see."""
    walk.window.page("robot").press_primary()
    let_work(0.5)
    walk.wait(lambda: walk.shown(QWidget, "hold_to_pour"), "the pour is planned", HANG_S)


def _judge(walk: Walk, objects: Path) -> None:
    """Judge the objects, unless an earlier window has."""
    page = walk.window.page("tuning")
    assert isinstance(page, TuningPage)
    page.open(objects)
    walk.wait(lambda: walk.window.desk.background.is_idle, "the objects are read", HANG_S)
    if "Run" in page.findChild(QPushButton, PRIMARY).text():
        page.press_primary()
        let_work(0.5)
        walk.wait_for_work("the objects are judged", HANG_S)


def _fit(walk: Walk, path: Path) -> None:
    """Fit, with settings that take seconds, and keep a picture of what was found."""
    page = walk.window.page("tuning")
    assert isinstance(page, TuningPage)
    if path.name.startswith("block"):
        return  # what is fitted does not depend on the session
    page.use_draft(("default", apply_settings(Parameters(), _QUICK_FIT)))
    walk.click("fit")
    source = page.findChild(QComboBox, "fit_input")
    source.setCurrentIndex(source.findData("mesh"))
    page.findChild(QSpinBox, "fit_seeds").setValue(1)
    page.findChild(QSpinBox, "fit_trials").setValue(20)
    walk.click("fit_start")
    let_work(0.5)
    walk.wait_for_work("the fit", HANG_S)
    _keep(walk, path)
    walk.click("fit_back")


def _compare(walk: Walk, library: Path, path: Path) -> None:
    """The two sessions beside each other."""
    if path.name.startswith("block"):
        return  # the same two
    page = walk.window.page("history")
    assert isinstance(page, HistoryPage)
    page.compare(*(library / name for name in OBJECTS))
    walk.wait(lambda: walk.window.desk.background.is_idle, "the sessions are compared", HANG_S)
    _keep(walk, path)
    page.press_primary()


def _keep(walk: Walk, path: Path) -> None:
    let_work(0.3)
    walk.wait(lambda: walk.window.desk.background.is_idle, "the page is loaded", HANG_S)
    walk.wait_for_work("the page's work", HANG_S)
    let_work(_SETTLING_S)
    walk.window.grab().save(str(path))
    with Image.open(path) as picture:
        opaque = picture.convert("RGB")
    opaque.save(path, optimize=True)
    print(path.name, flush=True)


if __name__ == "__main__":
    main()
