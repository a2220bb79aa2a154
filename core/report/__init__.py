"""The session's report: one HTML file that holds everything, and the plots in it.

matplotlib and jinja2 are loaded when something is drawn or written, not before.
"""

from core.report.content import Media, ReportContent
from core.report.footprint import footprint_plot
from core.report.motions import motion_sentence, operator_sentence, place_text
from core.report.page import write_report
from core.report.pour_map import pour_map
from core.report.sentences import choice_sentence, pours_sentence, verdict_sentence

__all__ = [
    "Media",
    "ReportContent",
    "choice_sentence",
    "footprint_plot",
    "motion_sentence",
    "operator_sentence",
    "place_text",
    "pour_map",
    "pours_sentence",
    "verdict_sentence",
    "write_report",
]
