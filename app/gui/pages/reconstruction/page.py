"""The Model page: the model, what is known of it, and what a changed parameter does to it."""

from __future__ import annotations

from functools import partial
from typing import Any

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QVBoxLayout
from typing_extensions import override

from app.gui.desk.desk import Desk
from app.gui.pages.background_page import BackgroundPage
from app.gui.pages.page import SplitView
from app.gui.pages.reconstruction.loading import Loaded, ModelKey, ShownModel, key_of, load_model
from app.gui.pages.reconstruction.modes import PHOTO
from app.gui.pages.reconstruction.side import STAGES, ModelSide
from app.gui.pages.reconstruction.view import ModelView
from app.jobs.session_work import SessionWork
from core.errors import InputError
from core.geometry import FloatArray
from core.parameters import apply_settings
from core.parameters.reconstruction import Point


class ReconstructionPage(BackgroundPage[ModelKey, Loaded]):
    """Shows the session's model, and remembers the one before to compare them."""

    KEY = "reconstruction"

    def __init__(self, desk: Desk) -> None:
        super().__init__(desk, load_model)
        self._last: ShownModel | None = None
        self._difference_m: FloatArray | None = None
        self._was_compared = False
        self.view = ModelView()
        self.side = ModelSide(desk)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(SplitView(self.view, self.side))
        self._connect()
        self.show_content(None)

    def _connect(self) -> None:
        self.side.primary.clicked.connect(self.reconstruct)
        self.side.scan_requested.connect(lambda: self.desk.page_wanted.emit("scan"))
        self.view.box_edited.connect(self._crop)
        self.view.crop.reset_wanted.connect(lambda: self._crop(None, None))
        self.desk.workspace.parameters_changed.connect(self._show_box)
        for signal in (self.desk.jobs.finished, self.desk.jobs.failed):
            signal.connect(lambda *_: QTimer.singleShot(0, self, self._compare))

    @property
    def model(self) -> ShownModel | None:
        """What is shown."""
        return None if self.content is None else self.content.model

    @override
    def content_key(self) -> ModelKey | None:
        view = self.desk.workspace.view
        return None if view is None else key_of(view)

    @override
    def show_content(self, former: Loaded | None) -> None:
        model, shown = self.model, None if former is None else former.model
        if self.content is None:
            self._last = self._difference_m = None
            self._was_compared = False
        elif shown is not None and model is not None and shown.digest != model.digest:
            self._last = shown if model.reconstruction is not None else None
            self._difference_m, self._was_compared = None, False
        self._show()
        self._compare()

    def reconstruct(self) -> None:
        """Reconstruct with the parameters as they are now."""
        desk = self.desk
        desk.jobs.start(
            self.tr("Reconstruct"),
            self.KEY,
            desk.session_host,
            SessionWork.reconstruct,
            desk.workspace.task(),
            steps=desk.workspace.steps_to("collision", "quality", "colors"),
        )

    def _compare(self) -> None:
        """Let the host find out how far the model lies off the one before, once nothing else runs."""
        last, model, jobs = self._last, self.model, self.desk.jobs
        if last is None or model is None or self._was_compared or not jobs.is_idle:
            return
        self._was_compared = True
        jobs.start(
            self.tr("Compare with the last model"),
            self.KEY,
            self.desk.session_host,
            SessionWork.compare_meshes,
            last.mesh,
            model.mesh,
            then=partial(self._take_difference, model),
        )

    def _take_difference(self, model: ShownModel, difference_m: Any) -> None:
        if self.model is None or model.digest != self.model.digest:  # it may have been read again meanwhile
            return
        self._difference_m = difference_m
        self._show()
        if self.view.modes.mode in ("shape", PHOTO):
            self.view.modes.choose("difference")

    def _show(self) -> None:
        """Show what is loaded."""
        model = self.model
        self.side.show_failure(self.failure)
        self.view.show_model(model, self._difference_m)
        if model is not None:
            self.side.show_model(model, self._last, self._difference_m)
        self._show_box()
        self.update_actions()

    def _show_empty(self) -> None:
        if self.desk.workspace.has("reconstruction") or self.desk.workspace.has("mesh"):
            words = self.tr("The model cannot be shown") if self.failure else self.tr("Loading the model …")
            self.side.show_empty(words, "")
            self.view.set_empty_text("")
        elif self.desk.workspace.has("scan"):
            self.side.show_empty(self.tr("Press Reconstruct to make a model of the scan."), "")
            self.view.set_empty_text(self.tr("The model appears here."))
        else:
            said = self.tr("The model of a scanned object appears here.")
            self.side.show_empty(said, self.tr("Go to Scan"))
            self.view.set_empty_text(said)

    def _show_box(self) -> None:
        own = None if self.content is None else self.content.own_box
        settings = self.desk.workspace.parameters.reconstruction
        if own is None:
            self.view.set_box(None, None, is_own=True)
        elif settings.crop_min_m is not None and settings.crop_max_m is not None:
            self.view.set_box(settings.crop_min_m, settings.crop_max_m, is_own=False)
        else:
            self.view.set_box(own.min_m, own.max_m, is_own=True)

    def _crop(self, low_m: Point | None, high_m: Point | None) -> None:
        """Take a crop box; none: the scan's own."""
        workspace = self.desk.workspace
        corners = {"reconstruction.crop_min_m": low_m, "reconstruction.crop_max_m": high_m}
        try:
            workspace.edit(apply_settings(workspace.parameters, corners), self.tr("crop box"))
        except InputError as error:
            self.report(error)
            self._show_box()

    @override
    def update_actions(self) -> None:
        """Enable what can be done now, and say it where there is no model."""
        if self.model is None:
            self._show_empty()
        workspace, primary = self.desk.workspace, self.side.primary
        is_mesh = workspace.has("mesh")
        has_input = is_mesh or workspace.has("scan")
        wanted = ("collision",) if is_mesh else STAGES
        is_done = has_input and all(workspace.is_fresh(stage) for stage in wanted)
        primary.setText(self.tr("Build collision model") if is_mesh else self.tr("Reconstruct"))
        primary.setEnabled(has_input and not is_done and self.desk.jobs.is_idle)
        if is_done:
            primary.setToolTip(self.tr("The model is up to date; change a parameter to make another one"))
        else:
            primary.setToolTip(self.tr("Make the model with the current parameters"))
        self.side.stale.look(workspace, primary.text())
