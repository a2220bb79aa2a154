"""The base of every parameter group, and how a field carries its unit, range and source."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field

CODE = "released code of Wu & Chirikjian"
PAPER = "Wu & Chirikjian, RA-L 2020"
OURS = "Poursight"


class Group(BaseModel):
    """A frozen set of parameters; unknown names and values that are not finite are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


def quantity(
    default: Any,
    doc: str,
    *,
    unit: str,
    source: str,
    low: float | None = None,
    high: float | None = None,
    is_written: bool = True,
) -> Any:
    """Declare a number (or numbers) in `unit` between `low` and `high`, both included.

    With `is_written` false a default is not written: records of before there was such a number stay the same.
    """
    return Field(
        default,
        description=doc,
        ge=low,
        le=high,
        exclude_if=None if is_written else lambda value: bool(value == default),
        json_schema_extra={"unit": unit, "source": source},
    )


def choice(default: Any, doc: str, *, source: str, is_written: bool = True) -> Any:
    """Declare a word out of a few (its type is a `Literal`) or a yes/no; see `quantity` for `is_written`."""
    return Field(
        default,
        description=doc,
        exclude_if=None if is_written else lambda value: bool(value == default),
        json_schema_extra={"unit": "", "source": source},
    )


def declaration(doc: str, *, source: str) -> Any:
    """Declare a yes/no that is no by default, and is not written then: records of before stay the same."""
    return Field(
        False,
        description=doc,
        exclude_if=lambda is_so: not is_so,
        json_schema_extra={"unit": "", "source": source},
    )
