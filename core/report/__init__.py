"""The session's report: one HTML file that holds everything, and the plots in it.

matplotlib and jinja2 are loaded when something is drawn or written, not before.
"""

from core.report.content import Media, ReportContent
from core.report.footprint import footprint_plot
from core.report.motions import motion_sentence, operator_sentence
from core.report.page import write_report
from core.report.pour_map import pour_map
from core.report.sentences import (
    capacity_text,
    choice_sentence,
    paper_verdict_sentence,
    place_text,
    pours_sentence,
    risk_sentence,
    tries_sentence,
    verdict_sentence,
)

__all__ = [
    "Media",
    "ReportContent",
    "capacity_text",
    "choice_sentence",
    "footprint_plot",
    "motion_sentence",
    "operator_sentence",
    "paper_verdict_sentence",
    "place_text",
    "pour_map",
    "pours_sentence",
    "risk_sentence",
    "tries_sentence",
    "verdict_sentence",
    "write_report",
]
