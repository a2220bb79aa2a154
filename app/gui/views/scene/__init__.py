"""The 3D view of the desktop: arm, meshes, camera views, candies, boxes and lines, in metres with z up."""

from app.gui.views.scene.candies import candy_legend
from app.gui.views.scene.layers import Frustum
from app.gui.views.scene.parts import ColorScale, PreparedMesh, prepare_mesh
from app.gui.views.scene.scene3d import Scene3D
from app.gui.views.scene.shapes import box_mesh, cylinder_mesh, revolved_mesh

__all__ = [
    "ColorScale",
    "Frustum",
    "PreparedMesh",
    "Scene3D",
    "box_mesh",
    "candy_legend",
    "cylinder_mesh",
    "prepare_mesh",
    "revolved_mesh",
]
