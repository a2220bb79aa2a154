"""Which of the labelled objects parameters are fitted to."""

from __future__ import annotations

from collections.abc import Sequence

from core.errors import InputError
from core.evaluation.labels import LabelledObject


def chosen_objects(
    objects: Sequence[LabelledObject], all_of_them: bool = False
) -> tuple[LabelledObject, ...]:
    """Return the objects to fit to: those marked for calibration, or all if none is or all are wanted.

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
