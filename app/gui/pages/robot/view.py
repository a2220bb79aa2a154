"""The cell in 3D: the arm as it is, and see-through what is planned, with a timeline to scrub."""

from __future__ import annotations

import time

import numpy as np
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from app.gui.pages.cell_model import CellModel
from app.gui.pages.layouts import lay_around
from app.gui.pages.robot.candies import PouredCandies
from app.gui.pages.robot.candy_layer import CandyLayer
from app.gui.pages.robot.loading import RobotCell
from app.gui.pages.robot.motion import Moment, ShownMotion, move_text
from app.gui.theme import GRID_PX
from app.gui.views.scene import PreparedMesh, Scene3D
from app.gui.views.scene.arm import ArmLooks
from app.gui.views.timeline import Section, Timeline
from core.geometry import FloatArray, make_pose
from core.motion.kinematics import flange_pose

AHEAD_S = 1.0
"""So far the ghost is ahead of the moving arm, in seconds of the plan."""
_CUP_OPACITY, _GHOST_CUP_OPACITY = 0.55, 0.3
_GHOST_ARM, _GHOST_CUP, _COLLISION = "planned arm", "planned cup", "collision shape"
_BEFORE_S, _AFTER_S = 1.5, 2.0
"""So long before and after the pour rotation the view is close to the object."""
_SEE_THROUGH = 0.45
_MOST_OFTEN_S = 0.09
_SAME_RAD = 5e-4
_APART_RAD = 0.01
"""Nearer than this the ghost would only blur the arm."""


class ArmView(QWidget):
    """Shows the cell, the object, the arm and the cup now, and the planned motion at the timeline's time.

    Attributes:
        scene: the 3D view.
        timeline: of the planned motion.
    """

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("arm_view")
        self._cell: RobotCell | None = None
        self._object: PreparedMesh | None = None
        self._motion: ShownMotion | None = None
        self._joints_rad: FloatArray | None = None
        self._last_seen_rad: FloatArray | None = None
        self._holds_cup: bool | None = False
        self._T_flange_cup: FloatArray | None = None
        self._drawn: tuple[FloatArray, bool | None] | None = None
        self._drawn_s = 0.0
        self._is_following = False
        self._is_near = False
        self.scene = Scene3D()
        self._candies = CandyLayer(self.scene)
        self.scene.setObjectName("robot_scene")
        self.scene.set_empty_text(self.tr("The arm is shown here."))
        self.timeline = Timeline()
        self.timeline.time_changed.connect(self._show_time)
        self._caption = QLabel()
        self._caption.setObjectName("arm_caption")
        self._now = QLabel()
        self._now.setObjectName("plan_now")
        self._hint = QLabel(self.tr("The planned motion can be inspected here before anything moves."))
        self._hint.setProperty("role", "muted")
        self._strip = QStackedWidget()
        self._collision = QPushButton(self.tr("Collision shape"))
        self._collision.setObjectName("collision_shape")
        self._collision.setCheckable(True)
        self._collision.setToolTip(
            self.tr("Show around the arm the shape that is kept clear of table, object and arm")
        )
        self._collision.toggled.connect(self._show_collision_shape)
        self._build()

    def _build(self) -> None:
        for line in (self._caption, self._now, self._hint):
            line.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self._strip.addWidget(self._hint)
        self._strip.addWidget(self.timeline)
        self._strip.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        bottom = QVBoxLayout()
        bottom.setContentsMargins(2 * GRID_PX, GRID_PX, GRID_PX, GRID_PX)
        bottom.addWidget(self._now)
        bottom.addWidget(self._strip)
        top = QHBoxLayout()
        top.setContentsMargins(2 * GRID_PX, GRID_PX, GRID_PX, GRID_PX)
        top.addWidget(self._caption, 1)
        top.addWidget(self._collision)
        lay_around(self, top, self.scene, bottom)
        self._show_caption()

    def show_cell(self, cell: RobotCell) -> None:
        """Show another cell, with its arm at home until something else is known."""
        self._cell = cell
        scene = self.scene
        cell.model.draw_furniture(scene)
        self._draw_platform_top()
        scene.set_label("station", cell.station_m, self.tr("cup station"))
        scene.set_points("corners", cell.corners_m, color="scene", size_px=1)  # unseen; kept in view
        scene.set_prepared_mesh("cup", cell.cup, color="kept", opacity=_CUP_OPACITY)
        scene.set_prepared_mesh(_GHOST_CUP, cell.cup, color="ghost", opacity=_GHOST_CUP_OPACITY)
        model = cell.model
        scene.set_arm(_GHOST_ARM, model.arm, model.home_rad, tools=model.tools, looks="ghost")
        self._set_arm(is_connected=self._joints_rad is not None)
        self._place_cup()
        self._show_time(self.timeline.time_s)
        scene.fit("corners")

    def show_object(self, mesh: PreparedMesh | None) -> None:
        """Show another object; none: none."""
        self._object = mesh
        if mesh is None:
            self.scene.remove("object")
        else:
            self.scene.set_prepared_mesh("object", mesh)
        self._draw_platform_top()

    def _draw_platform_top(self) -> None:
        if self._cell is not None:
            casters_m = np.empty((0, 3)) if self._object is None else self._object.vertices_m
            self._cell.model.draw_platform_top(self.scene, casters_m)

    def show_arm(
        self,
        joints_rad: FloatArray | None,
        holds_cup: bool | None,
        last_seen_rad: FloatArray | None = None,
    ) -> None:
        """Show where the arm is now.

        Args:
            joints_rad: (6,); none: it is not connected.
            holds_cup: whether the cup is in the hand, not at its station; none: nobody knows.
            last_seen_rad: (6,) where it is drawn while it is not connected; none: at home.
        """
        was_connected, is_connected = self._joints_rad is not None, joints_rad is not None
        is_elsewhere = not is_connected and last_seen_rad is not self._last_seen_rad
        self._joints_rad, self._holds_cup, self._last_seen_rad = joints_rad, holds_cup, last_seen_rad
        if self._cell is None:
            return
        if was_connected != is_connected or is_elsewhere:
            self._set_arm(is_connected)
            self._show_caption()
            self._place_cup()
        elif not self._is_following:  # while it moves, `follow` draws
            self._draw_arm()

    def show_motion(self, motion: ShownMotion | None) -> None:
        """Show what was planned from its beginning; none: nothing."""
        if motion is self._motion:
            return
        self._motion = motion
        for name in ("path", "pivot"):
            self.scene.remove(name)
        if motion is None:
            self.timeline.set_sections(0.0)
        else:
            self._T_flange_cup = motion.T_flange_cup
            self.scene.set_line("path", motion.mouth_m, color="ghost", width_px=2)
            if motion.pivot_m is not None:
                self.scene.set_label("pivot", motion.pivot_m, self.tr("pivot"))
            ends_s = [*motion.begins_s[1:], motion.duration_s]
            sections = [
                Section(move.label, begin_s, end_s)
                for move, begin_s, end_s in zip(motion.moves, motion.begins_s, ends_s, strict=True)
            ]
            self.timeline.set_sections(motion.duration_s, sections)
        self._strip.setCurrentWidget(self._hint if motion is None else self.timeline)
        if motion is None and self._truth is not None:
            self._replay(self._truth)
        self._show_time(self.timeline.time_s)
        self._show_caption()
        self._come_near()

    def show_candies(self, candies: PouredCandies | None) -> None:
        """Show the candies of the planned pour, or replay those of one that was made; none: none."""
        if candies is self._candies.candies:
            return
        self._candies.show(candies)
        if self._motion is None:
            self._replay(candies if candies is not None and candies.is_true else None)
        self._show_time(self.timeline.time_s)
        self._show_caption()
        self._come_near()

    def _replay(self, replayed: PouredCandies | None) -> None:
        """Offer to replay a pour that was made, shown at its end; none: nothing."""
        self._strip.setCurrentWidget(self._hint if replayed is None else self.timeline)
        if replayed is None:
            self.timeline.set_sections(0.0)
            return
        self.timeline.set_sections(
            replayed.duration_s, [Section(self.tr("simulated pour"), 0.0, replayed.duration_s)]
        )
        self.timeline.set_time(replayed.duration_s)

    def follow(self, done_s: float | None) -> None:
        """Let the timeline go with the moving arm, the ghost a little ahead; none: it has ended."""
        if (done_s is not None) != self._is_following:
            self._is_following = done_s is not None
            self.timeline.pause()
            self.timeline.setEnabled(not self._is_following)
            self._show_caption()
        elif done_s is None or time.monotonic() - self._drawn_s < _MOST_OFTEN_S:
            return
        self._drawn_s = time.monotonic()
        self._draw_arm()
        if done_s is not None:
            self.timeline.set_time(done_s)
        self._come_near()

    @property
    def _truth(self) -> PouredCandies | None:
        """The candies of a pour that was made, while nothing is planned; none if there are none."""
        candies = self._candies.candies
        return candies if candies is not None and candies.is_true and self._motion is None else None

    def _come_near(self) -> None:
        """Look at the object while candies leave the cup and when they lie there, else at the whole cell."""
        motion = self._motion
        is_pouring = self._is_following and motion is not None and motion.pivot_m is not None
        if is_pouring and motion is not None:
            begin_s, end_s = motion.pours_s
            is_pouring = begin_s - _BEFORE_S <= self.timeline.time_s <= end_s + _AFTER_S
        is_near = self._object is not None and (is_pouring or self._truth is not None)
        if is_near != self._is_near:
            self._is_near = is_near
            if self._object is not None:  # its walls would hide the candies in it
                opacity = _SEE_THROUGH if is_near else 1.0
                self.scene.set_prepared_mesh("object", self._object, opacity=opacity)
            self.scene.ease(*(("object",) if is_near else ("corners",)))

    def _draw_arm(self) -> None:
        """Bring the arm, and the cup in its hand, to where they are, if they were seen elsewhere."""
        joints_rad = self._joints_rad
        if joints_rad is None or self._cell is None:
            return
        drawn = self._drawn
        is_same_hand = drawn is not None and drawn[1] == self._holds_cup
        if drawn is not None and is_same_hand and not _differ(joints_rad, drawn[0], _SAME_RAD):
            return
        self._drawn = joints_rad, self._holds_cup
        self.scene.set_joints("arm", joints_rad)
        if self._collision.isChecked():
            self.scene.set_joints(_COLLISION, joints_rad)
        self._place_cup()

    def _set_arm(self, is_connected: bool) -> None:
        """An arm of which nobody knows where it is, is see-through."""
        assert self._cell is not None, "called when there is a cell"
        model = self._cell.model
        looks: ArmLooks = "solid" if is_connected else "ghost"
        self.scene.set_arm("arm", model.arm, self._drawn_rad(model), tools=model.tools, looks=looks)
        self._show_collision_shape()
        self._drawn = None

    def _show_collision_shape(self) -> None:
        """Draw what motions are checked with around the arm, or take it away."""
        if self._cell is None or not self._collision.isChecked():
            self.scene.remove(_COLLISION)
            return
        model = self._cell.model
        self.scene.set_arm(
            _COLLISION, model.arm, self._drawn_rad(model), tools=model.tools, looks="collision"
        )

    def _drawn_rad(self, model: CellModel) -> FloatArray:
        """Where it is, else where it was last seen, else its home."""
        known = (self._joints_rad, self._last_seen_rad, model.home_rad)
        return next(joints_rad for joints_rad in known if joints_rad is not None)

    def _place_cup(self) -> None:
        """In the hand or at its station; away if nobody knows where it is."""
        cell, joints_rad, T_flange_cup = self._cell, self._joints_rad, self._T_flange_cup
        if cell is None:
            return
        T_base_cup: FloatArray | None = make_pose(np.eye(3), cell.station_m)
        if self._holds_cup and joints_rad is not None and T_flange_cup is not None:
            T_base_cup = flange_pose(cell.model.arm, joints_rad) @ T_flange_cup
        elif self._holds_cup is not False:
            T_base_cup = None
        self.scene.set_visible("cup", T_base_cup is not None)
        if T_base_cup is not None:
            self.scene.set_pose("cup", T_base_cup)

    def _show_time(self, time_s: float) -> None:
        """Put the ghost to where the plan is at a time, and the candies to where they are then."""
        cell, motion = self._cell, self._motion
        if cell is None:
            return
        if motion is None:
            self.scene.set_visible(_GHOST_ARM, False)
            self._show_replay(time_s)
            return
        moment = motion.at(time_s + AHEAD_S if self._is_following else time_s)
        now_rad = self._joints_rad
        self.scene.set_joints(_GHOST_ARM, moment.joints_rad)
        is_apart = now_rad is None or _differ(moment.joints_rad, now_rad, _APART_RAD)
        self.scene.set_visible(_GHOST_ARM, is_apart)
        self.scene.set_visible(_GHOST_CUP, moment.holds_cup and is_apart)
        if moment.holds_cup:
            self.scene.set_pose(_GHOST_CUP, self._cup_at(cell, motion, moment))
        if motion.pivot_m is not None:
            self._candies.place(time_s, motion, self._cup_at(cell, motion, motion.at(time_s)))
        self._now.setText(move_text(motion.moves[motion.at(time_s).index].name))

    def _show_replay(self, time_s: float) -> None:
        truth = self._truth
        self.scene.set_visible(_GHOST_CUP, truth is not None)
        if truth is None:
            self._now.clear()
            return
        T_base_cup = truth.cup_pose(time_s)
        self.scene.set_pose(_GHOST_CUP, T_base_cup)
        self._candies.place(time_s, None, T_base_cup)
        self._now.setText(self.tr("The pour as it was driven, with the candies of the simulated cell."))

    def _cup_at(self, cell: RobotCell, motion: ShownMotion, moment: Moment) -> FloatArray:
        """(4, 4) in the hand, or on its station."""
        if moment.holds_cup:
            held: FloatArray = flange_pose(cell.model.arm, moment.joints_rad) @ motion.T_flange_cup
            return held
        return make_pose(np.eye(3), cell.station_m)

    def _show_caption(self) -> None:
        if self._joints_rad is None:
            said = self.tr("Not connected: the arm is drawn at its home position.")
            if self._last_seen_rad is not None:
                said = self.tr("Not connected: the arm is drawn where it was last seen.")
        elif self._motion is None:
            said = self.tr("The arm as it is now.")
        elif self._is_following:
            said = self.tr("Solid: now. Transparent: in one second.")
        else:
            said = self.tr("Solid: now. Transparent: the plan.")
        if self._candies.candies is not None and self._motion is not None:
            said += " " + self.tr("Candies: imagined.")
        elif self._truth is not None:
            said = self.tr("Simulated outcome: grey candies with a rim are spilled.")
        self._caption.setText(said)


def _differ(one_rad: FloatArray, other_rad: FloatArray, by_rad: float) -> bool:
    return bool(np.abs(one_rad - other_rad).max() > by_rad)
