"""Where to look again after a scan, told beforehand (the paper's future work)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from app.jobs.scan_news import Proposal

if TYPE_CHECKING:
    from hardware.cell import Cell, CellSettings


def propose_views(scan_folder: Path, settings: CellSettings) -> Proposal:
    """Choose reachable views that would show more of what a finished scan left hidden; 6 s if it hid much.

    Args:
        scan_folder: of the scan, taken in this cell.
        settings: the cell; nothing of it is connected.

    Raises:
        PoursightError: the scan cannot be read.
    """
    from core.progress import Reporter
    from core.quality.cavity import coarse_volume, find_hidden_cavity
    from core.scan import read_scan
    from hardware.scanning.looking_again import propose

    scan = read_scan(scan_folder, Reporter())
    volume = coarse_volume(scan, settings.place.crop_box)
    n_hidden = len(find_hidden_cavity(volume, settings.place.platform_height_m).region)
    if n_hidden == 0:
        return Proposal(0, 0.0)
    height, width = scan.frames[0].depth_m.shape
    proposals = propose(_unconnected(settings), volume, scan.intrinsics, (width, height))
    return Proposal(len(proposals), sum(n_revealed for _, n_revealed in proposals) / n_hidden)


def _unconnected(settings: CellSettings) -> Cell:
    """The cell with its arm and obstacles; a simulated one has nothing on its platform."""
    import numpy as np

    from hardware.cell import open_cell
    from hardware.simulation.world import World

    if not settings.is_simulated:
        return open_cell(settings)
    table_m = np.array([*settings.place.platform_center_m[:2], settings.place.table_height_m])
    return open_cell(settings, World(None, table_m))
