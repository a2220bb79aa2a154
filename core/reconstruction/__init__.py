"""From a scan to the object's mesh: TSDF fusion, segmentation, and how well the poses agree."""

from core.reconstruction.pose_health import PoseHealth, ViewHealth, measure_pose_health, measure_view_health
from core.reconstruction.refinement import Refinement, ViewCorrection
from core.reconstruction.result import Reconstruction
from core.reconstruction.stage import reconstruct
from core.reconstruction.tsdf import TsdfVolume

__all__ = [
    "PoseHealth",
    "Reconstruction",
    "Refinement",
    "TsdfVolume",
    "ViewCorrection",
    "ViewHealth",
    "measure_pose_health",
    "measure_view_health",
    "reconstruct",
]
