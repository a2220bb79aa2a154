"""Colours and sizes, light and dark. Red belongs to STOP alone; nothing is shown by colour only."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QFont, QGuiApplication, QPalette
from PySide6.QtWidgets import QApplication, QWidget

from core.resources import RESOURCES

GRID_PX = 8
"""Distances are multiples of it."""
_POINT_SIZE = 10
_ICONS = RESOURCES / "icons"


@dataclass(frozen=True)
class Theme:
    """Named colours, `#rrggbb`.

    Attributes:
        name: `light` or `dark`.
        window: behind everything.
        surface: of panels and inputs.
        raised: of buttons, headers and chips.
        line: separators.
        text: primary text.
        muted: secondary text.
        accent: the one colour that says "here": primary buttons, selection, progress.
        on_accent: text on it.
        good: a state that is as it should be.
        attention: for what needs a look: stale, poor, a warning, a real cell.
        failed: something went wrong; not red, which is reserved for STOP.
        simulated: the simulated cell's chip.
        stop: STOP, and nothing else.
        kept: candies that stayed.
        lost: candies that did not.
        scene: background of 3D views.
        ground: of the plane that things stand on in 3D.
        grid: of the lines on it.
        body: of the object in 3D.
        arm: of the arm in 3D.
        ghost: of the planned arm in 3D.
    """

    name: str
    window: str
    surface: str
    raised: str
    line: str
    text: str
    muted: str
    accent: str
    on_accent: str
    good: str
    attention: str
    failed: str
    simulated: str
    stop: str
    kept: str
    lost: str
    scene: str
    ground: str
    grid: str
    body: str
    arm: str
    ghost: str

    def color(self, name: str) -> QColor:
        """Return a named colour for painting, or the one that is `#rrggbb` in every theme."""
        return QColor(name if name.startswith("#") else getattr(self, name))

    @property
    def is_dark(self) -> bool:
        """Whether it is light text on dark."""
        return self.name == "dark"


LIGHT = Theme(
    name="light",
    window="#f3f4f6",
    surface="#ffffff",
    raised="#e7e9ed",
    line="#cfd3da",
    text="#1b1f26",
    muted="#596273",
    accent="#0b6e75",
    on_accent="#ffffff",
    good="#2f7d4f",
    attention="#9a5b00",
    failed="#8b3a86",
    simulated="#1f5fbf",
    stop="#d0021b",
    kept="#1f6fd0",
    lost="#d98a00",
    scene="#e3e6eb",
    ground="#f4f4f2",
    grid="#c9cdd4",
    body="#b9bfc9",
    arm="#8d97a6",
    ghost="#0b8a92",
)
DARK = Theme(
    name="dark",
    window="#16191e",
    surface="#1e2229",
    raised="#2a2f38",
    line="#3b424e",
    text="#e8ebf0",
    muted="#a0a9b8",
    accent="#3fb6bd",
    on_accent="#0c1416",
    good="#6fc792",
    attention="#f0b04a",
    failed="#d78ad2",
    simulated="#7fb0ff",
    stop="#e5152e",
    kept="#5aa2f5",
    lost="#f2ae3d",
    scene="#12151a",
    ground="#272b32",
    grid="#434a55",
    body="#aab1bd",
    arm="#7f8998",
    ghost="#4fd0d8",
)
THEMES = {theme.name: theme for theme in (LIGHT, DARK)}


def theme_of(widget: QWidget) -> Theme:
    """Return the theme a widget is shown in; Qt repaints the widget when it changes.

    Its window tells: a widget with a ground of its own, such as STOP, has that in its palette.
    """
    window = widget.window().palette().color(QPalette.ColorRole.Window)
    return DARK if window.lightnessF() < 0.5 else LIGHT


def theme_named(name: str) -> Theme:
    """Return a theme by its name; `system`: the one the desktop environment uses."""
    if name in THEMES:
        return THEMES[name]
    is_dark = QGuiApplication.styleHints().colorScheme() == Qt.ColorScheme.Dark
    return DARK if is_dark else LIGHT


def apply_theme(application: QApplication, theme: Theme) -> None:
    """Show the program in a theme, now and for every widget made later."""
    application.setStyle("Fusion")
    font = QFont(application.font())
    font.setPointSize(_POINT_SIZE)
    application.setFont(font)
    application.setPalette(palette_of(theme))
    application.setStyleSheet(style_sheet(theme))


def palette_of(theme: Theme) -> QPalette:
    """Return Qt's palette for a theme."""
    role = QPalette.ColorRole
    named = {
        role.Window: theme.window,
        role.WindowText: theme.text,
        role.Base: theme.surface,
        role.AlternateBase: theme.window,
        role.Text: theme.text,
        role.PlaceholderText: theme.muted,
        role.Button: theme.raised,
        role.ButtonText: theme.text,
        role.BrightText: theme.text,
        role.ToolTipBase: theme.raised,
        role.ToolTipText: theme.text,
        role.Highlight: theme.accent,
        role.HighlightedText: theme.on_accent,
        role.Link: theme.accent,
        role.LinkVisited: theme.accent,
        role.Accent: theme.accent,
        role.Mid: theme.line,
        role.Midlight: theme.line,
        role.Light: theme.raised,
        role.Dark: theme.line,
        role.Shadow: theme.line,
    }
    palette = QPalette()
    for one, color in named.items():
        palette.setColor(one, QColor(color))
    disabled = QPalette.ColorGroup.Disabled
    for one in (role.WindowText, role.Text, role.ButtonText):
        palette.setColor(disabled, one, QColor(theme.muted))
    palette.setColor(disabled, role.Highlight, QColor(theme.line))
    return palette


def style_sheet(theme: Theme) -> str:
    """Return what the palette cannot say: roles of buttons and labels, given by the property `role`."""
    t = theme
    return f"""
    QToolTip {{ color: {t.text}; background: {t.raised}; border: 1px solid {t.line}; padding: 4px; }}
    QPushButton {{
        background: {t.raised}; color: {t.text}; border: 1px solid {t.line}; border-radius: 4px;
        padding: 5px 12px; min-height: 18px;
    }}
    QPushButton:hover {{ border-color: {t.accent}; }}
    QPushButton:pressed {{ background: {t.line}; }}
    QPushButton:focus {{ border: 2px solid {t.accent}; padding: 4px 11px; }}
    QPushButton:disabled {{ color: {t.muted}; background: {t.window}; }}
    QPushButton:checked {{
        background: {t.surface}; color: {t.accent}; border: 2px solid {t.accent};
        padding: 4px 11px;
    }}
    QPushButton:checked:focus {{ border-color: {t.text}; }}
    QPushButton[role="primary"] {{
        background: {t.accent}; color: {t.on_accent}; border-color: {t.accent}; font-weight: 600;
        padding: 8px 20px;
    }}
    QPushButton[role="primary"]:focus {{ border: 2px solid {t.text}; padding: 7px 19px; }}
    QPushButton[role="primary"]:disabled {{
        background: {t.raised}; color: {t.muted}; border-color: {t.line};
    }}
    QPushButton[role="link"] {{
        background: transparent; border: none; color: {t.accent}; text-align: left; padding: 2px 0;
    }}
    QPushButton[role="link"]:focus {{ text-decoration: underline; }}
    QPushButton[role="session"] {{
        background: transparent; border-color: transparent; text-align: left; padding: 5px 8px;
        font-size: 13pt; font-weight: 600;
    }}
    QPushButton[role="session"]:hover {{ background: {t.raised}; }}
    QPushButton[role="session"]:focus {{ border: 2px solid {t.accent}; padding: 4px 7px; }}
    QPushButton[role="next"] {{
        background: transparent; color: {t.accent}; border: 2px solid {t.accent}; font-weight: 600;
        padding: 6px 16px;
    }}
    QPushButton[role="next"]:hover {{ background: {t.raised}; }}
    QPushButton[role="next"]:focus {{ border-color: {t.text}; }}
    QLineEdit {{
        border: 1px solid {t.muted}; border-radius: 4px; padding: 3px 4px; background: {t.surface};
    }}
    QLineEdit:focus {{ border-color: {t.accent}; }}
    QAbstractSpinBox > QLineEdit, QComboBox > QLineEdit {{ border: none; padding: 0; }}
    QCheckBox::indicator, QTreeView::indicator {{
        width: 16px; height: 16px; border: 1px solid {t.muted}; border-radius: 3px; background: {t.surface};
    }}
    QCheckBox::indicator:checked, QTreeView::indicator:checked {{
        background: {t.accent}; border-color: {t.accent}; image: url({_ICONS.as_posix()}/check-{t.name}.svg);
    }}
    QCheckBox::indicator:disabled {{ border-color: {t.line}; background: {t.window}; }}
    QPushButton#stop {{
        background: {t.stop}; color: #ffffff; border: 2px solid {t.stop}; border-radius: 6px;
        font-size: 16pt; font-weight: 800; padding: 0; min-height: 58px; min-width: 118px;
    }}
    QPushButton#stop:pressed {{ border-color: #ffffff; }}
    QWidget#stop_panel {{ background: {t.surface}; }}
    QWidget#stop_panel QPushButton#stop {{ min-height: 0; min-width: 0; }}
    QLabel#stop_channel {{ color: {t.muted}; font-size: 7pt; }}
    QFrame#top_bar {{ background: {t.surface}; border: none; border-bottom: 1px solid {t.line}; }}
    QFrame#tab_list {{ background: {t.window}; border: none; border-right: 1px solid {t.line}; }}
    QFrame#job_bar {{ background: {t.surface}; border: none; border-top: 1px solid {t.line}; }}
    QFrame#message_bar {{ background: {t.raised}; border: none; border-bottom: 1px solid {t.line}; }}
    QFrame#log_drawer QPlainTextEdit {{ border: none; border-top: 1px solid {t.line}; }}
    QLabel[role="title"] {{ font-size: 13pt; font-weight: 600; }}
    QLabel[role="heading"] {{ font-weight: 600; }}
    QLabel[role="verdict"] {{ font-size: 12pt; font-weight: 600; }}
    QLabel[role="muted"] {{ color: {t.muted}; }}
    QLabel[role="attention"] {{ color: {t.attention}; }}
    QLabel[role="failed"] {{ color: {t.failed}; }}
    QFrame#side_panel {{ background: {t.surface}; border: none; border-left: 1px solid {t.line}; }}
    QFrame#side_panel QWidget#side_body {{ background: {t.surface}; }}
    QSplitter::handle {{ background: {t.line}; }}
    QFrame[role="line"] {{ background: {t.line}; border: none; max-height: 1px; min-height: 1px; }}
    QHeaderView::section {{
        background: {t.raised}; color: {t.text}; border: none; border-bottom: 1px solid {t.line};
        padding: 4px 6px; font-weight: 600;
    }}
    QTableView, QTreeView, QListView {{ border: 1px solid {t.line}; gridline-color: {t.line}; }}
    """
