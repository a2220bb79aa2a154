"""What each file of a session must hold, declared once; `core.files` holds what it reads against it.

A newer version's extra keys are left out, a missing or wrong one is named with its file. Light to import.
"""

from core.formats.arrays import check_arrays
from core.formats.checks import MADE_BY_REPORT, check_table, kind_of
from core.formats.text import excerpt, is_text, parse_json

__all__ = ["MADE_BY_REPORT", "check_arrays", "check_table", "excerpt", "is_text", "kind_of", "parse_json"]
