"""The candies of a pour in the 3D view: in the cup, leaving it, in the object, and those that are spilled."""

from __future__ import annotations

from app.gui.pages.robot.candies import PouredCandies
from app.gui.pages.robot.motion import ShownMotion
from app.gui.views.scene import Scene3D
from core.geometry import FloatArray

CANDIES = "candies"


class CandyLayer:
    """Places the candies at a time of a motion, or of the replay of a pour that was made.

    Attributes:
        candies: of which pour; none: none are shown.
    """

    def __init__(self, scene: Scene3D) -> None:
        self.candies: PouredCandies | None = None
        self._scene = scene

    def show(self, candies: PouredCandies | None) -> None:
        """Show other candies."""
        self.candies = candies
        self._scene.remove(CANDIES)
        if candies is not None:
            is_colourful = candies.kept | candies.stays_in_cup
            self._scene.set_candies(CANDIES, len(candies.kept), candies.shape, is_colourful)

    def place(self, time_s: float, motion: ShownMotion | None, T_base_cup: FloatArray) -> None:
        """Bring the candies to where they are at a time.

        Args:
            time_s: of the motion; without one of the replay.
            motion: that pours; none: a pour that was made is replayed.
            T_base_cup: (4, 4) the cup then.
        """
        candies = self.candies
        if candies is None:
            return
        since_s = 0.0 if motion is None else time_s - motion.pours_s[0]
        if motion is None:
            poses = candies.at(time_s)
        elif since_s < 0:
            poses = candies.carried(-since_s, T_base_cup)
        else:
            turn_s = motion.pours_s[1] - motion.pours_s[0]
            turned_s = candies.turn_s * min(since_s / turn_s, 1.0)
            poses = candies.after(candies.settle_s + turned_s + max(since_s - turn_s, 0.0), T_base_cup)
        self._scene.set_candy_poses(CANDIES, *poses)
