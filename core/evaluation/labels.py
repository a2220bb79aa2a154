"""Labelled objects: a folder of meshes beside a CSV that says which of them are containers (Sec. IV-B)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, nan
from pathlib import Path
from typing import Literal, get_args

from core.errors import InputError
from core.files import is_file, read_csv, reason
from core.formats import excerpt

Label = Literal["container", "non-container", "ambiguous"]
LABELS: tuple[Label, ...] = get_args(Label)
MESHES_FOLDER = "meshes"
ANSWER_COLUMNS = ("object", "annotator", "contains", "pourable")
_ENDINGS = (".obj", ".ply", ".stl", ".off", ".glb")
_LONGEST_NAME = 200
"""Bytes: endings and numbers come to it, and a file's name has 255 at most."""
_YES, _NO = ("1", "yes", "true", "y"), ("0", "no", "false", "n")

_Row = Mapping[str, str | None]


@dataclass(frozen=True)
class Agreement:
    """The answers of the people who were asked about one object.

    Attributes:
        n_container: said that it can hold candies and that they could pour them in.
        n_asked: people.
    """

    n_container: int
    n_asked: int

    @property
    def is_container(self) -> bool:
        """More than half said so: 3 of 5 (Sec. IV-B)."""
        return 2 * self.n_container > self.n_asked


@dataclass(frozen=True)
class LabelledObject:
    """A mesh and what a person would call it.

    Attributes:
        name: unique among the objects.
        label: an ambiguous object counts in no accuracy.
        mesh: its file, in metres.
        category: what it is, such as "mug"; may be empty.
        notes: more about it; may be empty.
        is_restricted: whether it belongs to the restricted set (Sec. IV-B).
        is_calibration: whether parameters may be fitted to it.
        agreement: of the people who were asked, where the labels are raw answers; none otherwise.
        capacity_ml: to its lowest rim; none where it is not known.
    """

    name: str
    label: Label
    mesh: Path
    category: str = ""
    notes: str = ""
    is_restricted: bool = False
    is_calibration: bool = False
    agreement: Agreement | None = None
    capacity_ml: float | None = None


def read_labels(folder: Path, labels: Path | None = None) -> tuple[LabelledObject, ...]:
    """Read the objects of a folder: meshes in it or in `meshes`, and a CSV with the columns id and label.

    Instead of labels the CSV may hold raw answers, with the columns object, annotator, contains and pourable:
    then the majority decides (Sec. IV-B). The columns restricted and calib may mark objects, and capacity_ml
    may say what they hold.

    Args:
        folder: that holds the meshes.
        labels: the CSV; none: the one in the folder.

    Raises:
        InputError: there is no such file, or a row of it cannot be used.
    """
    path = labels or _only_csv(folder)
    try:
        columns, rows = read_csv(path)
    except (OSError, ValueError) as error:
        raise InputError(
            f"The labels {path} cannot be read ({reason(error)}); give a CSV in UTF-8 with id and label."
        ) from error
    if not rows:
        raise InputError(f"The labels {path} name no object; give a row with id and label for each.")
    if all(column in columns for column in ANSWER_COLUMNS):
        return _from_answers(folder, path, rows)
    objects = tuple(_object(folder, row, _text(row, "id"), _label(path, row)) for row in rows)
    ((name, times),) = Counter(one.name for one in objects).most_common(1)
    if times > 1:
        raise InputError(
            f"The labels {path} name the object '{excerpt(name)}' twice; leave one of the rows out."
        )
    return objects


def objects_to_fit(
    objects: Sequence[LabelledObject], all_of_them: bool = False
) -> tuple[LabelledObject, ...]:
    """Return the objects to fit to: those marked for it, or all if none is marked or all are wanted.

    Raises:
        InputError: none of them is a container, or all are.
    """
    labelled = tuple(one for one in objects if one.label != "ambiguous")
    marked = tuple(one for one in labelled if one.is_calibration)
    chosen = labelled if all_of_them or not marked else marked
    labels = {one.label for one in chosen}
    if len(labels) < 2:
        kind = " and ".join(sorted(labels)) or "nothing"
        raise InputError(
            f"Parameters are fitted to containers and other objects, but there is only {kind} among the "
            f"{len(chosen)} objects; label both kinds."
        )
    return chosen


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


def _object(
    folder: Path, row: _Row, name: str, label: Label, agreement: Agreement | None = None
) -> LabelledObject:
    if not _is_plain(name):
        raise InputError(
            f"'{excerpt(name)}', an object of {folder}, cannot be a file's name, as it has to; use letters, "
            "digits and hyphens."
        )
    return LabelledObject(
        name,
        label,
        _mesh(folder, name),
        _text(row, "category"),
        _text(row, "notes"),
        _is_marked(row, "restricted"),
        _is_marked(row, "calib"),
        agreement,
        _capacity_ml(row, name),
    )


def _capacity_ml(row: _Row, name: str) -> float | None:
    text = _text(row, "capacity_ml")
    if not text:
        return None
    try:
        capacity_ml = float(text)
    except ValueError:
        capacity_ml = nan
    if not 0 <= capacity_ml < inf:
        raise InputError(
            f"'{excerpt(text)}', the capacity_ml of '{excerpt(name)}', is no volume; give millilitres, or "
            "leave it empty."
        )
    return capacity_ml


def _label(path: Path, row: _Row) -> Label:
    label = next((one for one in LABELS if one == _text(row, "label")), None)
    if label is None or not _text(row, "id"):
        raise InputError(
            f"In {path}, the row {excerpt(row)} cannot be used: it needs an id, and a label that is one of "
            f"{', '.join(LABELS)}."
        )
    return label


def _from_answers(folder: Path, path: Path, rows: Sequence[_Row]) -> tuple[LabelledObject, ...]:
    """Sum up raw answers by object, in the order of the file; the first row of an object has its marks."""
    votes: dict[str, dict[str, bool]] = {}
    for row in rows:
        name, annotator = _text(row, "object"), _text(row, "annotator")
        answers = [_answer(path, row, column) for column in ("contains", "pourable")]
        if not name or not annotator:
            raise InputError(f"In {path}, the row {excerpt(row)} lacks the object or the annotator.")
        if annotator in votes.setdefault(name, {}):
            raise InputError(
                f"In {path}, '{excerpt(annotator)}' answers twice about '{excerpt(name)}'; leave one row out."
            )
        votes[name][annotator] = all(answers)
    first_rows = {_text(row, "object"): row for row in reversed(rows)}
    objects = []
    for name, by_annotator in votes.items():
        agreement = Agreement(sum(by_annotator.values()), len(by_annotator))
        if 2 * agreement.n_container == agreement.n_asked:
            raise InputError(
                f"In {path}, the {agreement.n_asked} answers about '{excerpt(name)}' are split evenly; "
                "ask one more person, or give labels instead of answers."
            )
        label: Label = "container" if agreement.is_container else "non-container"
        objects.append(_object(folder, first_rows[name], name, label, agreement))
    return tuple(objects)


def _answer(path: Path, row: _Row, column: str) -> bool:
    text = _text(row, column).lower()
    if text not in _YES + _NO:
        raise InputError(
            f"In {path}, '{excerpt(text)}' in the column {column} is no answer; write 1 or 0 (or yes or no)."
        )
    return text in _YES


def _text(row: _Row, column: str) -> str:
    return (row.get(column) or "").strip()


def _is_marked(row: _Row, column: str) -> bool:
    return _text(row, column).lower() not in ("", *_NO)


def _mesh(folder: Path, name: str) -> Path:
    """The object's file; where there is none, where it should be: judging it then says so."""
    places = [place / f"{name}{ending}" for place in (folder / MESHES_FOLDER, folder) for ending in _ENDINGS]
    return next((path for path in places if is_file(path)), places[0])


def _is_plain(name: str) -> bool:
    """Whether a name is fit for a file in any folder; a folder within that of the objects may precede it."""
    parts = name.split("/")
    return (
        len(name.encode("utf-8", "replace")) <= _LONGEST_NAME
        and name.isprintable()
        and "\\" not in name
        and not any(part in ("", ".", "..") for part in parts)
    )
