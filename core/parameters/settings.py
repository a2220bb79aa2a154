"""Parameters by dotted name: listing them, setting them from text, and what differs between two sets."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from core.errors import InputError
from core.files import is_file, read_content, reason
from core.formats import excerpt, parse_json
from core.parameters.fields import Group
from core.parameters.model import Parameters
from core.resources import RESOURCES

G = TypeVar("G", bound=Group)
"""Any group of parameters, such as all of them."""


@dataclass(frozen=True)
class FieldFacts:
    """What an editor, a help text or an error message says of one parameter."""

    name: str
    doc: str
    unit: str
    source: str
    low: float | None
    high: float | None
    choices: tuple[str, ...]
    default: Any

    @property
    def range_text(self) -> str:
        """The range in words, such as '0 to 1' or 'one of box, plane'."""
        if self.choices:
            return "one of " + ", ".join(self.choices)
        if self.low is None or self.high is None:
            return ""
        return f"{self.low:.10g} to {self.high:.10g}" + (f" {self.unit}" if self.unit else "")


def flatten(parameters: Group, prefix: str = "") -> dict[str, Any]:
    """Return `{dotted name: value}` of all parameters, in their order."""
    flat: dict[str, Any] = {}
    for name in type(parameters).model_fields:
        value = getattr(parameters, name)
        if isinstance(value, Group):
            flat |= flatten(value, f"{prefix}{name}.")
        else:
            flat[prefix + name] = value
    return flat


def describe(group: Group | None = None, prefix: str = "") -> list[FieldFacts]:
    """Return the facts of every parameter, in their order."""
    group = Parameters() if group is None else group
    facts: list[FieldFacts] = []
    for name, field in type(group).model_fields.items():
        value = getattr(group, name)
        if isinstance(value, Group):
            facts += describe(value, f"{prefix}{name}.")
        else:
            facts.append(_facts(prefix + name, field, value))
    return facts


def difference(parameters: Parameters, base: Parameters) -> dict[str, tuple[Any, Any]]:
    """Return `{name: (value in base, value)}` for every parameter that differs."""
    before = flatten(base)
    return {
        name: (before[name], value) for name, value in flatten(parameters).items() if value != before[name]
    }


def apply_settings(parameters: G, settings: Mapping[str, Any]) -> G:
    """Return a copy with `{dotted name: value or its text}` set.

    Raises:
        InputError: a name is unknown (the nearest is offered) or a value lies outside its range.
    """
    known = flatten(parameters)
    tree = parameters.model_dump()
    for name, value in settings.items():
        if name not in known:
            raise InputError(
                f"There is no parameter '{excerpt(name)}'; did you mean '{nearest(excerpt(name), known)}'?"
            )
        *groups, leaf = name.split(".")
        branch = tree
        for group in groups:
            branch = branch[group]
        branch[leaf] = _parse(value)
    try:
        return type(parameters).model_validate(tree)
    except ValidationError as error:
        raise InputError(_explain(error, describe(parameters))) from error


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the known name most like `name`; the part after the last dot counts most."""
    names = list(known)
    leaf = name.rsplit(".", 1)[-1]

    def likeness(candidate: str) -> float:
        whole = difflib.SequenceMatcher(None, name, candidate).ratio()
        return whole + difflib.SequenceMatcher(None, leaf, candidate.rsplit(".", 1)[-1]).ratio()

    return max(names, key=likeness)


def _parse(value: Any) -> Any:
    if not isinstance(value, str):
        return value
    try:
        return parse_json(value.encode())
    except ValueError:
        return value


def _facts(name: str, field: FieldInfo, default: Any) -> FieldFacts:
    extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
    bounds = {
        key: getattr(item, key) for item in field.metadata for key in ("ge", "le") if hasattr(item, key)
    }
    choices = get_args(field.annotation) if isinstance(default, str) else ()
    return FieldFacts(
        name=name,
        doc=field.description or "",
        unit=str(extra.get("unit", "")),
        source=str(extra.get("source", "")),
        low=bounds.get("ge"),
        high=bounds.get("le"),
        choices=tuple(str(word) for word in choices),
        default=default,
    )


def _explain(error: ValidationError, known: Iterable[FieldFacts]) -> str:
    """One sentence on the first thing wrong."""
    first = error.errors()[0]
    facts = {fact.name: fact for fact in known}
    path = [str(part) for part in first["loc"]]
    while path and ".".join(path) not in facts:
        path.pop()
    name = ".".join(path) or ".".join(str(part) for part in first["loc"])
    said = str(first["msg"]).removeprefix("Value error, ")
    if name not in facts:
        return f"The parameters in '{name}' do not fit together: {said}."
    allowed = facts[name].range_text
    hint = f"; allowed is {allowed}" if allowed else f": {said}"
    return f"{name} = {excerpt(repr(first['input']))} is not possible{hint}."


PRESET_FOLDER = RESOURCES / "presets"
PRESET_NAMES = ("default", *sorted(path.stem for path in PRESET_FOLDER.glob("*.json")))


def load_preset(name_or_file: str) -> Parameters:
    """Return a shipped preset by its name, or one saved in a JSON file of `{"parameters": {name: value}}`.

    Raises:
        InputError: there is no such preset, or its file cannot be used.
    """
    if name_or_file == "default":
        return Parameters()
    if name_or_file in PRESET_NAMES:
        return apply_settings(Parameters(), _read(PRESET_FOLDER / f"{name_or_file}.json"))
    if is_file(Path(name_or_file)):
        return apply_settings(Parameters(), _read(Path(name_or_file)))
    said = excerpt(name_or_file)
    raise InputError(
        f"There is no preset '{said}'; did you mean '{nearest(said, PRESET_NAMES)}'? "
        f"Known are {', '.join(PRESET_NAMES)}, or give a preset file."
    )


def _read(path: Path) -> dict[str, Any]:
    try:
        settings = parse_json(read_content(path))["parameters"]
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise InputError(
            f"The preset file {path} cannot be read ({reason(error)}); "
            "it must be JSON with a table 'parameters'."
        ) from error
    if not isinstance(settings, dict):
        raise InputError(f"In the preset file {path}, 'parameters' must be a table of names and values.")
    return settings
