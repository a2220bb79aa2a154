"""Making the whole program light or dark: a palette for Qt's own widgets, a little style sheet for ours."""

from __future__ import annotations

from PySide6.QtGui import QColor, QFont, QPalette
from PySide6.QtWidgets import QApplication

from app.gui.theme import Theme
from core.resources import RESOURCES

POINT_SIZE = 10
_ICONS = RESOURCES / "icons"


def apply_theme(application: QApplication, theme: Theme) -> None:
    """Show the program in a theme, now and for every widget made later."""
    application.setStyle("Fusion")
    font = QFont(application.font())
    font.setPointSize(POINT_SIZE)
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
    QPushButton:focus {{ border: 1px solid {t.accent}; }}
    QPushButton:disabled {{ color: {t.muted}; background: {t.window}; }}
    QPushButton:checked {{ background: {t.accent}; color: {t.on_accent}; border-color: {t.accent}; }}
    QPushButton[role="primary"] {{
        background: {t.accent}; color: {t.on_accent}; border-color: {t.accent}; font-weight: 600;
        padding: 8px 20px;
    }}
    QPushButton[role="primary"]:disabled {{
        background: {t.raised}; color: {t.muted}; border-color: {t.line};
    }}
    QPushButton[role="link"] {{
        background: transparent; border: none; color: {t.accent}; text-align: left; padding: 2px 0;
    }}
    QPushButton[role="next"] {{
        background: transparent; color: {t.accent}; border: 2px solid {t.accent}; font-weight: 600;
        padding: 6px 16px;
    }}
    QPushButton[role="next"]:hover {{ background: {t.raised}; }}
    QLineEdit {{
        border: 1px solid {t.muted}; border-radius: 4px; padding: 3px 4px; background: {t.surface};
    }}
    QLineEdit:focus {{ border-color: {t.accent}; }}
    QAbstractSpinBox > QLineEdit, QComboBox > QLineEdit {{ border: none; padding: 0; }}
    QCheckBox::indicator {{
        width: 16px; height: 16px; border: 1px solid {t.muted}; border-radius: 3px; background: {t.surface};
    }}
    QCheckBox::indicator:checked {{
        background: {t.accent}; border-color: {t.accent}; image: url({_ICONS.as_posix()}/check-{t.name}.svg);
    }}
    QCheckBox::indicator:disabled {{ border-color: {t.line}; background: {t.window}; }}
    QPushButton#stop {{
        background: {t.stop}; color: #ffffff; border: 2px solid {t.stop}; border-radius: 6px;
        font-size: 16pt; font-weight: 800; padding: 0; min-height: 58px; min-width: 118px;
    }}
    QPushButton#stop:pressed {{ border-color: #ffffff; }}
    QFrame#top_bar {{ background: {t.surface}; border: none; border-bottom: 1px solid {t.line}; }}
    QFrame#tab_list {{ background: {t.window}; border: none; border-right: 1px solid {t.line}; }}
    QFrame#job_bar {{ background: {t.surface}; border: none; border-top: 1px solid {t.line}; }}
    QFrame#message_bar {{ background: {t.raised}; border: none; border-bottom: 1px solid {t.line}; }}
    QFrame#log_drawer QPlainTextEdit {{ border: none; border-top: 1px solid {t.line}; }}
    QProgressBar {{ background: {t.raised}; border: none; border-radius: 3px; }}
    QProgressBar::chunk {{ background: {t.accent}; border-radius: 3px; }}
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
