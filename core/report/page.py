"""The report's page: one HTML file that needs nothing else."""

from __future__ import annotations

from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from core.files import write_whole
from core.imagination.advice import advice_against
from core.imagination.amount.result import amount_text
from core.imagination.results import Containability, PourGrid
from core.imagination.retention.result import Retention, retention_sentence
from core.report.content import ReportContent
from core.report.media import data_uri, embed_films, embed_pictures
from core.report.plots import footprint_plot, pour_map, retention_plot
from core.report.sentences import (
    MM,
    has_spread,
    known_sentence,
    motion_sentence,
    omega_texts,
    omega_verdict_sentence,
    operator_sentence,
    pours_sentence,
    risk_sentence,
    verdict_sentence,
)
from core.report.tables import (
    health_sentence,
    motion_reasons,
    motion_rows,
    object_facts,
    parameter_rows,
    pour_rows,
    refinement_sentence,
    retention_facts,
    risk_rows,
    run_rows,
    time_rows,
    view_rows,
)
from core.resources import RESOURCES
from core.session import explained

TEMPLATE = "report.html.j2"


def write_report(content: ReportContent, path: Path) -> None:
    """Write the report as one self-contained HTML file, whole or not at all.

    Raises:
        SessionError: the disk is full or the folder may not be written.
    """
    page = render_page(content)
    with explained(path.parent):
        write_whole(path, page)


def render_page(content: ReportContent) -> str:
    """Return the page's HTML; all text in it is escaped."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(RESOURCES / "report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(TEMPLATE).render(_page_data(content))


def _page_data(content: ReportContent) -> dict[str, Any]:
    found = content.containability
    return {
        "content": content,
        "created": _readable_time(content.created),
        "verdict": verdict_sentence(found),
        "paper_verdict": "" if found.verdict is None else omega_verdict_sentence(found),
        "retention_facts": retention_facts(content.capacity, content.retention),
        "capacity_remark": "" if content.capacity is None else content.capacity.remark,
        "retention_plot": _retention_plot(content.retention),
        "retention_said": "" if content.retention is None else retention_sentence(content.retention),
        "amount_said": ""
        if content.amount is None or not found.is_open_container
        else amount_text(content.amount),
        "advice": _advice(content),
        "pours_said": pours_sentence(found, content.pours, content.choice),
        "footprint_plot": _both(footprint_plot(found), footprint_plot(found, dark=True)),
        "pictures": embed_pictures(content.pictures),
        "films": embed_films(content.films),
        "model_pictures": embed_pictures(content.model_pictures),
        "scan_pictures": embed_pictures(content.scan_pictures),
        "object_facts": object_facts(content.surface, content.reconstruction),
        "parameter_rows": parameter_rows(content.parameters, content.preset),
        "time_rows": time_rows(dict(content.seconds)),
        "known_said": known_sentence(content.known_s),
        "total_s": f"{sum(content.seconds.values()):.1f}",
        "operator_said": _operator_said(content),
        **_omega_data(found),
        **_pour_data(content),
        **_motion_data(content),
        **_reconstruction_data(content),
    }


def _retention_plot(retention: Retention | None) -> dict[str, str] | None:
    """The curve; none where nothing was loaded that could leave."""
    if retention is None or retention.n_load == 0:
        return None
    return _both(retention_plot(retention), retention_plot(retention, dark=True))


def _omega_data(found: Containability) -> dict[str, Any]:
    omega, threshold = omega_texts(found)
    return {
        "omega_percent": round(100 * found.omega, 1),
        "threshold_percent": round(100 * min(found.omega_threshold, 1.0), 1),
        "omega_said": f"Omega {omega}, threshold {threshold}",
    }


def _pour_data(content: ReportContent) -> dict[str, Any]:
    grid = content.pours
    if grid is None:
        return {"pour_map": None}
    light = pour_map(grid, content.choice, content.containability)
    dark = pour_map(grid, content.choice, content.containability, dark=True)
    return {
        "pour_map": _both(light, dark),
        "pour_rows": pour_rows(grid, content.choice),
        "risk_said": _risk_said(content, grid),
        "risk_rows": risk_rows(grid, content.risk, content.choice),
        "indents": [f"{indent_m * MM:.0f}" for indent_m in grid.indent_m],
        "spread_said": f"; ± over {grid.n_in.shape[2]} packings of the cup" if has_spread(grid) else "",
    }


def _risk_said(content: ReportContent, grid: PourGrid) -> str:
    if content.risk is None or content.choice is None or content.paper_choice is None:
        return ""
    return risk_sentence(grid, content.risk, content.choice, content.paper_choice)


def _advice(content: ReportContent) -> str:
    """Against the pour that the program would make; who chose another one has made up his mind."""
    choice = content.choice if content.motions is None else content.motions.choice
    if choice is None or content.operator is not None:
        return ""
    return advice_against(content.risk, choice.i, choice.j, content.parameters.risk.wanted_clean)


def _operator_said(content: ReportContent) -> str:
    if content.operator is None or content.pours is None:
        return ""
    program = content.motions.choice if content.motions is not None else content.choice
    return operator_sentence(content.operator, content.pours, program)


def _motion_data(content: ReportContent) -> dict[str, Any]:
    grid, motions = content.pours, content.motions
    if grid is None or motions is None:
        return {"motion_said": None, "arm_decided": False, "run_rows": run_rows(content.runs)}
    return {
        "arm_decided": motions.is_changed,
        "motion_said": motion_sentence(motions, grid),
        "motion_rows": motion_rows(motions, grid),
        "motion_reasons": motion_reasons(motions, grid),
        "run_rows": run_rows(content.runs),
    }


def _reconstruction_data(content: ReportContent) -> dict[str, Any]:
    if content.reconstruction is None:
        return {}
    return {
        "health_said": health_sentence(content.reconstruction),
        "view_rows": view_rows(content.reconstruction),
        "refinement_said": refinement_sentence(content.reconstruction),
    }


def _readable_time(created: str) -> str:
    try:
        return datetime.fromisoformat(created).astimezone(timezone.utc).strftime("%d %B %Y, %H:%M UTC")
    except (OverflowError, ValueError):
        return created


def _both(light: bytes, dark: bytes) -> dict[str, str]:
    """Return a plot for light pages and paper, and for dark ones."""
    return {"light": data_uri("image/png", light), "dark": data_uri("image/png", dark)}
