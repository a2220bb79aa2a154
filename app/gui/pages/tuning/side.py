"""The Tune page's side panel: the parameters for the next run, a preset's name, and the buttons that run."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QLineEdit, QPushButton, QSizePolicy

from app.gui.pages.page import SidePanel
from app.gui.pages.saved_presets import preset_names, preset_tips
from app.gui.theme import GRID_PX
from app.gui.views.labels import text_label
from app.gui.views.parameter_editor.editor import ParameterEditor
from core.stages import groups_of

GROUPS = tuple(group for group in groups_of("collision", "judgement", "retention") if group != "seed")
_EDITOR_PX = 240


class TuningSide(SidePanel):
    """Parameter editor, the preset's name, and the buttons that run.

    Attributes:
        editor: of the parameters that decide the score.
        fit: leads to fitting them.
        save_wanted: the name of a preset to be saved.
    """

    save_wanted = Signal(str)

    def __init__(self) -> None:
        super().__init__("")
        self.primary.setText(self.tr("Run all"))
        self.run_selected = QPushButton(self.tr("Run selected"))
        self.run_selected.setObjectName("run_selected")
        self.run_selected.setMinimumHeight(5 * GRID_PX)
        self.fit = QPushButton(self.tr("Fit…"))
        self.fit.setObjectName("fit")
        self.fit.setMinimumHeight(5 * GRID_PX)
        self.fit.setToolTip(self.tr("Search for parameters that separate containers from other objects"))
        self.add_button(self.fit)
        self.add_button(self.run_selected)
        self.column_note = text_label("column_note")
        self.editor = ParameterEditor(GROUPS)
        # it takes the height that is left, and scrolls by itself: the panel around it must not
        self.editor.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Ignored)
        self.editor.setMinimumHeight(_EDITOR_PX)
        self._offer_presets()
        self.body.addWidget(self.column_note)
        self.body.addWidget(self.editor, 1)
        self.body.addLayout(self._build_saving())

    def _build_saving(self) -> QHBoxLayout:
        self._name = QLineEdit()
        self._name.setObjectName("preset_name")
        self._name.setAccessibleName(self.tr("Name of the preset"))
        self._name.setPlaceholderText(self.tr("name of a preset"))
        self._save = QPushButton(self.tr("Save as preset"))
        self._save.setObjectName("save_preset")
        self._save.setEnabled(False)
        self._save.setToolTip(self.tr("Save these parameters; every list of presets will offer them"))
        self._name.textChanged.connect(lambda text: self._save.setEnabled(bool(text.strip())))
        self._save.clicked.connect(lambda: self.save_wanted.emit(self._name.text().strip()))
        row = QHBoxLayout()
        row.setSpacing(GRID_PX)
        row.addWidget(self._name, 1)
        row.addWidget(self._save)
        return row

    def preset_saved(self) -> None:
        """A preset was saved: offer it, and forget its name."""
        self._offer_presets()
        self._name.clear()

    def _offer_presets(self) -> None:
        names = preset_names()
        self.editor.set_preset_names(names, preset_tips(names))
