"""Editing the method's parameters: one row each, judged by the schema, told against a preset."""

from app.gui.views.parameter_editor.editor import ParameterEditor

__all__ = ["ParameterEditor"]
