"""From a scan to the object's mesh: TSDF fusion, segmentation, and how well the poses agree."""
