"""Objects with labels: a folder of meshes beside a CSV that says which of them are containers."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from core.errors import InputError
from core.evaluation.answers import Agreement, is_answer_table, majority

Label = Literal["container", "non-container", "ambiguous"]
LABELS: tuple[Label, ...] = get_args(Label)
MESHES_FOLDER = "meshes"
_ENDINGS = (".obj", ".ply", ".stl", ".off", ".glb")
_NO = ("", "0", "no", "false", "n")


@dataclass(frozen=True)
class LabelledObject:
    """A mesh and what a person would call it.

    Attributes:
        name: unique among the objects.
        label: an ambiguous one counts in no accuracy.
        mesh: its file, in metres.
        category: what it is, such as "mug"; may be empty.
        notes: more about it; may be empty.
        is_restricted: whether it belongs to the restricted set (Sec. IV-B).
        is_calibration: whether parameters may be fitted to it.
        agreement: of the people who were asked, where the labels are raw answers; none otherwise.
    """

    name: str
    label: Label
    mesh: Path
    category: str = ""
    notes: str = ""
    is_restricted: bool = False
    is_calibration: bool = False
    agreement: Agreement | None = None


def read_labels(folder: Path, labels: Path | None = None) -> tuple[LabelledObject, ...]:
    """Read the objects of a folder: meshes in it or in `meshes`, and a CSV with the columns id and label.

    Instead of labels the CSV may hold raw answers, with the columns object, annotator, contains and pourable:
    then the majority decides (Sec. IV-B). The columns restricted and calib may mark objects.

    Args:
        folder: that holds the meshes.
        labels: the CSV; none: the one in the folder.

    Raises:
        InputError: there is no such file, or a row of it cannot be used.
    """
    path = labels or _only_csv(folder)
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = list(csv.DictReader(file))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(
            f"The labels {path} cannot be read ({error}); give a CSV with id and label."
        ) from error
    if not rows:
        raise InputError(f"The labels {path} name no object; give a row with id and label for each.")
    if is_answer_table(rows[0]):
        return _of_answers(folder, path, rows)
    objects = tuple(_object(folder, path, row) for row in rows)
    names = [one.name for one in objects]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"The labels {path} name the object '{twice}' twice; leave one of the rows out.")
    return objects


def _only_csv(folder: Path) -> Path:
    found = sorted(folder.glob("*.csv"))
    if not found:
        raise InputError(
            f"{folder} holds no labels; put a CSV with the columns id and label (container, non-container or "
            "ambiguous) beside the meshes."
        )
    preferred = [path for path in found if path.stem in ("labels", "manifest")]
    if len(found) > 1 and not preferred:
        raise InputError(f"{folder} holds several CSV files; call the one with the labels 'labels.csv'.")
    return (preferred or found)[0]


def _object(folder: Path, path: Path, row: Mapping[str, str | None]) -> LabelledObject:
    name, label = (row.get("id") or "").strip(), (row.get("label") or "").strip()
    known = next((one for one in LABELS if one == label), None)
    if not name or known is None:
        raise InputError(
            f"In {path}, the row {dict(row)} cannot be used: it needs an id, and a label that is one of "
            f"{', '.join(LABELS)}."
        )
    return LabelledObject(
        name,
        known,
        _mesh(folder, name),
        (row.get("category") or "").strip(),
        (row.get("notes") or "").strip(),
        _is_marked(row, "restricted"),
        _is_marked(row, "calib"),
    )


def _of_answers(
    folder: Path, path: Path, rows: Sequence[Mapping[str, str | None]]
) -> tuple[LabelledObject, ...]:
    marks = {(row.get("object") or "").strip(): row for row in reversed(rows)}
    return tuple(
        LabelledObject(
            name,
            "container" if agreement.is_container else "non-container",
            _mesh(folder, name),
            (marks[name].get("category") or "").strip(),
            (marks[name].get("notes") or "").strip(),
            _is_marked(marks[name], "restricted"),
            _is_marked(marks[name], "calib"),
            agreement,
        )
        for name, agreement in majority(path, rows).items()
    )


def _is_marked(row: Mapping[str, str | None], column: str) -> bool:
    return (row.get(column) or "").strip().lower() not in _NO


def _mesh(folder: Path, name: str) -> Path:
    """The object's file; where there is none, where it should be: judging it then says so."""
    places = [place / f"{name}{ending}" for place in (folder / MESHES_FOLDER, folder) for ending in _ENDINGS]
    return next((path for path in places if path.is_file()), places[0])
