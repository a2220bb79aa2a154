"""The robot's scan (Sec. IV-A): view by view, each on disk before the arm moves on."""

from hardware.scanning.control import ScanControl
from hardware.scanning.keeping import ScanKeeper
from hardware.scanning.procedure import ScanProcedure
from hardware.scanning.views import PlannedView, ViewRecord, ViewState

__all__ = ["PlannedView", "ScanControl", "ScanKeeper", "ScanProcedure", "ViewRecord", "ViewState"]
