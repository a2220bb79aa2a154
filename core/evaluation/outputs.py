"""What an evaluation's folder holds for people and for other programs.

report.html   the tables, the curves and every object, in one file that needs nothing else
tables.txt    Tables I and II as they are printed
objects.csv   one row an object and seed, of the first variant
trials.csv    the same of all variants
summary.json  the figures
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from pathlib import Path

from core.evaluation.evaluation import Evaluation
from core.evaluation.plain_text import text_tables
from core.evaluation.tables import CSV_COLUMNS, csv_rows
from core.evaluation.trials import Trial

__all__ = ["REPORT_FILE", "text_tables", "write_outputs"]

REPORT_FILE, TABLES_FILE = "report.html", "tables.txt"
OBJECTS_FILE, TRIALS_FILE, SUMMARY_FILE = "objects.csv", "trials.csv", "summary.json"


def write_outputs(evaluation: Evaluation, folder: Path) -> Path:
    """Write the tables and the report of an evaluation.

    Args:
        evaluation: with its trials.
        folder: that also holds the pictures.

    Returns:
        The report's path.

    Raises:
        SessionError: the disk is full or the folder may not be written.
    """
    from core.evaluation.pages.rendering import write_whole
    from core.evaluation.pages.report import report_page
    from core.evaluation.summary import summary_of
    from core.files import write_json
    from core.session.explaining import explained

    first = evaluation.of_variant(evaluation.variants[0])
    write_whole(folder / OBJECTS_FILE, _csv(evaluation, first))
    write_whole(folder / TRIALS_FILE, _csv(evaluation, evaluation.trials))
    write_whole(folder / TABLES_FILE, text_tables(evaluation))
    with explained(folder):
        write_json(folder / SUMMARY_FILE, summary_of(evaluation))
    write_whole(folder / REPORT_FILE, report_page(evaluation, folder))
    return folder / REPORT_FILE


def _csv(evaluation: Evaluation, trials: Iterable[Trial]) -> str:
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(CSV_COLUMNS)
    table.writerows(csv_rows(evaluation, trials))
    return text.getvalue()
