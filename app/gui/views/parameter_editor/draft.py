"""The edit itself, without widgets: what is set, what was refused and why."""

from __future__ import annotations

from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

from app.gui.views.parameter_editor.naming import Display
from core.errors import InputError
from core.parameters import FieldFacts, Parameters, apply_settings, describe, flatten
from core.parameters.fields import Group

Kind = Literal["yes_no", "choice", "integer", "number", "point"]


def kinds() -> dict[str, tuple[Kind, bool]]:
    """Return `{dotted name: (kind of value, whether None means automatic)}` of all parameters."""
    return _kinds_of(Parameters(), "")


def _kinds_of(group: Group, prefix: str) -> dict[str, tuple[Kind, bool]]:
    found: dict[str, tuple[Kind, bool]] = {}
    for name, field in type(group).model_fields.items():
        value = getattr(group, name)
        if isinstance(value, Group):
            found |= _kinds_of(value, f"{prefix}{name}.")
        else:
            found[prefix + name] = _kind(field.annotation)
    return found


def _kind(annotation: Any) -> tuple[Kind, bool]:
    if get_origin(annotation) in (Union, UnionType):
        inner = [part for part in get_args(annotation) if part is not NoneType]
        return _kind(inner[0])[0], True
    if get_origin(annotation) is Literal:
        return "choice", False
    if get_origin(annotation) is tuple:
        return "point", False
    simple: dict[Any, Kind] = {bool: "yes_no", int: "integer", float: "number"}
    return simple[annotation], False


class Draft:
    """Parameters under edit against a preset.

    A value that is possible only together with another (a corner of a box, a least and a most) is refused at
    first and tried again with the next one, so that both can be entered one after the other.

    Attributes:
        facts: what the schema says of each parameter, by its dotted name.
        kinds: of its values, as in `kinds`.
        displays: how its values are written.
        parameters: as they are now; always valid.
        preset: what they are compared with.
        errors: `{dotted name: why the value just entered was refused}`.
    """

    def __init__(self, parameters: Parameters, preset: Parameters) -> None:
        self.facts: dict[str, FieldFacts] = {fact.name: fact for fact in describe()}
        self.kinds = kinds()
        self.displays = {name: Display.of(fact) for name, fact in self.facts.items()}
        self.parameters = parameters
        self.preset = preset
        self.errors: dict[str, str] = {}
        self._refused: dict[str, Any] = {}
        self._values = flatten(parameters)
        self._preset_values = flatten(preset)

    def load(self, parameters: Parameters, preset: Parameters) -> None:
        """Start over from other parameters."""
        self.preset = preset
        self._preset_values = flatten(preset)
        self._adopt(parameters)

    def value(self, name: str) -> Any:
        """The value of a parameter."""
        return self._values[name]

    def preset_value(self, name: str) -> Any:
        """The value the preset has."""
        return self._preset_values[name]

    def differs(self, name: str) -> bool:
        """Whether a parameter differs from the preset."""
        return bool(self._values[name] != self._preset_values[name])

    def set(self, name: str, value: Any) -> bool:
        """Set a parameter if that is possible, else keep the old value and put the reason into `errors`.

        Returns:
            Whether the parameters changed.
        """
        if value == self._values[name]:
            self.errors.pop(name, None)
            self._refused.pop(name, None)
            return False
        try:
            self._adopt(apply_settings(self.parameters, {name: value}))
        except InputError as error:
            if not self._set_with_refused(name, value):
                self._refuse(name, value, error)
                return False
        return True

    def _adopt(self, parameters: Parameters) -> None:
        self.parameters = parameters
        self._values = flatten(parameters)
        self.errors.clear()
        self._refused.clear()

    def _set_with_refused(self, name: str, value: Any) -> bool:
        group = name.rpartition(".")[0]
        others = {key: old for key, old in self._refused.items() if key.rpartition(".")[0] == group}
        if not others:
            return False
        try:
            self._adopt(apply_settings(self.parameters, others | {name: value}))
        except InputError:
            return False
        return True

    def _refuse(self, name: str, value: Any, error: InputError) -> None:
        display = self.displays[name]
        if display.is_outside(value):
            # the error speaks in the parameter's own unit; the row shows another
            self.errors[name] = f"{display.text(value)} is not possible; allowed is {display.range_text()}."
        else:
            self.errors[name] = f"{error} It will be tried again with your next change in this group."
            self._refused[name] = value
