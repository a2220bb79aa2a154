"""The session's report: one HTML file that holds everything, and the plots in it.

matplotlib and jinja2 are loaded when something is drawn or written, not before.
"""

from core.report.content import Media, ReportContent
from core.report.page import write_report
from core.report.plots import footprint_plot, pour_map
from core.report.sentences import (
    capacity_text,
    choice_sentence,
    motion_sentence,
    omega_verdict_sentence,
    operator_sentence,
    place_text,
    pours_sentence,
    risk_sentence,
    tries_sentence,
    verdict_parts,
    verdict_reason,
    verdict_sentence,
    verdict_summary,
    verdict_words,
)

__all__ = [
    "Media",
    "ReportContent",
    "capacity_text",
    "choice_sentence",
    "footprint_plot",
    "motion_sentence",
    "omega_verdict_sentence",
    "operator_sentence",
    "place_text",
    "pour_map",
    "pours_sentence",
    "risk_sentence",
    "tries_sentence",
    "verdict_parts",
    "verdict_reason",
    "verdict_sentence",
    "verdict_summary",
    "verdict_words",
    "write_report",
]
