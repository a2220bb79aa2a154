"""Is a scan good enough, what did it not see, and where to look again."""

from core.quality.cavity import (
    HiddenCavity,
    coarse_volume,
    empty_coarse_volume,
    find_hidden_cavity,
    fuse_coarsely,
)
from core.quality.coverage import count_views, unseen_share
from core.quality.measures import ScanQuality
from core.quality.next_views import DepthCamera, ProposedView, propose_views
from core.quality.verdict import assess
from core.quality.view_quality import ViewQuality, check_view

__all__ = [
    "DepthCamera",
    "HiddenCavity",
    "ProposedView",
    "ScanQuality",
    "ViewQuality",
    "assess",
    "check_view",
    "coarse_volume",
    "count_views",
    "empty_coarse_volume",
    "find_hidden_cavity",
    "fuse_coarsely",
    "propose_views",
    "unseen_share",
]
