"""The final check of a plan: every sample of every move, from scratch, whatever made the plan."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from core.errors import MotionError
from core.geometry import FloatArray, rotation_z
from core.imagination.cup import cup_pose, pivot_in_cup_m, pour_angle
from core.motion.arm_models import JOINT_NAMES
from core.motion.joint_path import STEP_RAD
from core.motion.kinematics import branch_of, singularity_measure, within_limits
from core.motion.pour.cell import PourCell
from core.motion.pour.geometry import grasp_of_cup, imagined_rate
from core.motion.pour.plan import MOVES, PlannedMove, PourPlan, PourTarget, Segment
from core.motion.pour.scene import LeastClearance, PourScene, check_clearance, distinct
from core.motion.pour.tool_path import STEP_M, SpeedLimits
from core.motion.trajectory import SAMPLE_S
from core.parameters.imagination import PouringParameters

_SAME_RAD = 1e-6
_ROUNDING = 1 + 1e-6
_CLOCK_S = 1e-9
_PLACE_M = 0.001
_TILT_RAD = np.radians(0.1)
_ANGLE_RAD = 1e-4
_RATE_SHARE = 1e-3
_RATE_RAD_S = 1e-3
_UPRIGHT = frozenset({Segment.LIFT, Segment.CARRY, Segment.CARRY_BACK, Segment.PUT_DOWN})
_TILTING = frozenset({Segment.TILT, Segment.LOWER, Segment.RAISE, Segment.TILT_BACK})
_VERTICAL = frozenset({Segment.LIFT, Segment.LOWER, Segment.RAISE, Segment.PUT_DOWN})
_POURING = frozenset({Segment.POUR, Segment.ROTATE_BACK})
_AWAY = _TILTING | _POURING | {Segment.CARRY, Segment.CARRY_BACK}
"""The moves with the cup away from its station."""


def check_plan(cell: PourCell, target: PourTarget, plan: PourPlan) -> None:
    """Verify every sample of a plan again, for a cell and a pour.

    Raises:
        MotionError: names the move and what is wrong with it.
    """
    scene = PourScene(cell, target.object_aabb_m, target.pouring.cup)
    checked_plan(scene, target, plan.moves, plan.T_grasp_cup)


def checked_plan(
    scene: PourScene,
    target: PourTarget,
    moves: tuple[PlannedMove, ...],
    T_grasp_cup: FloatArray,
    at_station: LeastClearance | None = None,
) -> PourPlan:
    """Verify every sample of a pour's moves and return them as a plan, with what was measured.

    Where the clearance of the moves at the station was just checked, it may be passed: many pours share them.

    Raises:
        MotionError: names the move and what is wrong with it.
    """
    _check_sequence(scene, moves)
    known: set[tuple[bool, bytes]] = set()
    for move in moves:
        _check_samples(scene, move)
        joints, is_pour = move.trajectory.joints_rad, move.name in _POURING
        if (is_pour, joints.tobytes()) not in known:
            _check_speeds(scene, move)
        # a move back is as fast as the move out
        known.add((is_pour, joints[::-1].tobytes()))
    singularity = _check_branch(scene, [move for move in moves if move.holds_cup])
    _check_handling(scene, target.pouring, moves, T_grasp_cup)
    pivot_error, turn_s = _check_rotation(scene, target, moves, T_grasp_cup)
    if at_station is None:
        clearance = check_clearance(scene, moves)
    else:
        away = [move for move in moves if move.name in _AWAY]
        clearance = check_clearance(scene, away).with_other(at_station)
    return PourPlan(
        i=target.i,
        j=target.j,
        moves=moves,
        T_grasp_cup=T_grasp_cup,
        clearance_m=clearance.clearance_m,
        nearest=clearance.nearest,
        cup_clearance_m=clearance.cup_clearance_m,
        pivot_error_m=pivot_error,
        singularity=singularity,
        imagined_turn_s=target.pouring.turn_s,
        turn_s=turn_s,
    )


def _check_sequence(scene: PourScene, moves: Sequence[PlannedMove]) -> None:
    facts = tuple((move.name, move.phase, move.holds_cup, move.gripper_after) for move in moves)
    if facts != MOVES:
        raise MotionError("The plan's moves are not those of a pour in their order; plan the pour again.")
    for before, after in pairwise(moves):
        gap = float(np.abs(after.trajectory.start_rad - before.trajectory.end_rad).max())
        if not gap <= _SAME_RAD:
            raise MotionError(
                f"The move '{after.label}' starts {np.degrees(gap):.2g} degrees from the end of "
                f"'{before.label}'; plan the pour again."
            )
    away = float(np.abs(moves[-1].trajectory.end_rad - scene.cell.home_rad).max())
    if not away <= _SAME_RAD:
        raise MotionError("The plan does not end at the home configuration; plan the pour again.")


def _check_samples(scene: PourScene, move: PlannedMove) -> None:
    """Samples every 8 ms, within the joints' limits."""
    times, joints = move.trajectory.times_s, move.trajectory.joints_rad
    if joints.shape != (len(times), 6) or len(times) < 2 or not np.isfinite(joints).all():
        raise MotionError(f"The move '{move.label}' has invalid samples; plan the pour again.")
    if not np.abs(times - SAMPLE_S * np.arange(len(times))).max() <= _CLOCK_S:
        raise MotionError(f"The move '{move.label}' is not sampled every 8 ms; plan the pour again.")
    inside = within_limits(scene.cell.arm, joints)
    if not inside.all():
        joint = JOINT_NAMES[int((~inside).any(axis=0).argmax())]
        raise MotionError(f"In the move '{move.label}' the {joint} joint is beyond its limit.")


def _check_speeds(scene: PourScene, move: PlannedMove) -> None:
    """Not too fast, and samples close to each other."""
    joints, settings = move.trajectory.joints_rad, scene.cell.limits
    is_pour = move.name in _POURING
    limits = SpeedLimits.of_pour(settings) if is_pour else SpeedLimits.of_transfer(settings)
    steps = np.diff(joints, axis=0)
    points = scene.hand_points(scene.grasp_poses(joints))
    measured = (
        ("a joint moves at", np.abs(steps).max() / SAMPLE_S, limits.joint_speed_rad_s, "rad/s"),
        (
            "a joint accelerates by",
            move.trajectory.peak_acceleration_rad_s2,
            limits.joint_acceleration_rad_s2,
            "rad/s²",
        ),
        ("the hand moves at", _longest(points[:, :1]) / SAMPLE_S, limits.tool_speed_m_s, "m/s"),
        ("two samples of a joint differ by", np.abs(steps).max(), STEP_RAD, "rad"),
        ("the cup jumps by", _longest(points), STEP_M, "m"),
    )
    for what, value, limit, unit in measured:
        if not value <= limit * _ROUNDING:
            raise MotionError(
                f"In the move '{move.label}' {what} {value:.3g} {unit}, where {limit:.3g} {unit} is allowed."
            )


def _longest(points_m: FloatArray) -> float:
    """The longest step of points (N, P, 3)."""
    return float(np.linalg.norm(np.diff(points_m, axis=0), axis=2).max(initial=0))


def _check_branch(scene: PourScene, moves: Sequence[PlannedMove]) -> float:
    """One branch for as long as the cup is held; the smallest singularity measure."""
    joints, owners = distinct(moves)
    branches = branch_of(scene.cell.arm, joints)
    measures = singularity_measure(scene.cell.arm, joints)
    k, required = int(measures.argmin()), scene.cell.limits.min_singularity
    if not measures[k] >= required:
        raise MotionError(
            f"In the move '{moves[owners[k]].label}' the arm comes too close to a singular configuration "
            f"({measures[k]:.3f}, where {required:g} is allowed)."
        )
    if (branches != branches[0]).any():
        move = moves[owners[int((branches != branches[0]).argmax())]]
        raise MotionError(f"In the move '{move.label}' the arm changes its branch with the cup in its hand.")
    return float(measures[k])


def _check_handling(
    scene: PourScene, pouring: PouringParameters, moves: Sequence[PlannedMove], T_grasp_cup: FloatArray
) -> None:
    """Refuse a cup that is not gripped at its station, lifted straight, kept level and set down again."""
    psi = float(np.arctan2(T_grasp_cup[1, 0], T_grasp_cup[0, 0]))
    if not np.abs(T_grasp_cup - grasp_of_cup(psi, scene.cell.grip_height_m)).max() <= 1e-9:
        raise MotionError(
            "The plan's cup does not sit in the hand as the cell file says; plan the pour again."
        )
    for move in moves:
        if not move.holds_cup:
            continue
        cups = scene.held_cups(move.trajectory.joints_rad)
        if move.name in _UPRIGHT:
            _check_tilt(move, cups, scene.cell.limits.max_tilt_rad)
        elif move.name in _TILTING:
            _check_tilt(move, cups, np.pi / 2 - pouring.cup.slant_rad + _TILT_RAD)
        if move.name in _VERTICAL and not np.ptp(cups[:, :2, 3], axis=0).max() <= _PLACE_M:
            raise MotionError(f"In the move '{move.label}' the cup does not move straight up or down.")
    _check_at_station(scene, next(move for move in moves if move.name == Segment.GRASP))
    _check_at_station(scene, next(move for move in moves if move.name == Segment.PUT_DOWN))


def _tilts_rad(T_base_cup: FloatArray) -> FloatArray:
    """Tilts (N,) of cups (N, 4, 4) from upright."""
    return np.asarray(np.arccos(np.clip(T_base_cup[:, 2, 2], -1, 1)))


def _check_tilt(move: PlannedMove, cups: FloatArray, most_rad: float) -> None:
    tilt = float(_tilts_rad(cups).max())
    if not tilt <= most_rad:
        raise MotionError(
            f"In the move '{move.label}' the cup tilts by {np.degrees(tilt):.1f} degrees, where "
            f"{np.degrees(most_rad):.1f} are allowed."
        )


def _check_at_station(scene: PourScene, move: PlannedMove) -> None:
    cup = scene.held_cups(move.trajectory.joints_rad[-1:])
    off = float(np.linalg.norm(cup[0, :3, 3] - scene.cell.cup_station_m))
    if not (off <= _PLACE_M and _tilts_rad(cup)[0] <= _TILT_RAD):
        raise MotionError(
            f"The move '{move.label}' ends {off * 1000:.1f} mm from the cup's station; plan the pour again."
        )


def _check_rotation(
    scene: PourScene, target: PourTarget, moves: Sequence[PlannedMove], T_grasp_cup: FloatArray
) -> tuple[float, float]:
    """Verify the pour rotation, there and back; return the pivot's displacement and the duration.

    The cup rotates about l_pour (Sec. III-B) alone, from gamma = 0 to gamma_0; it is at rest before and after
    for at least the imagined times, and never ahead of the imagined rotation nor faster at the same angle.
    """
    there = next(move for move in moves if move.name == Segment.POUR)
    back = next(move for move in moves if move.name == Segment.ROTATE_BACK)
    tolerance = scene.cell.limits.pivot_tolerance_m
    worst = 0.0
    gammas = {}
    for move in (there, back):
        cups = scene.grasp_poses(move.trajectory.joints_rad) @ T_grasp_cup
        error, gammas[move.name] = _rotated(target, move, cups)
        if not error <= tolerance:
            raise MotionError(
                f"In the move '{move.label}' the pivot moves by {error * 1000:.2f} mm, where "
                f"{tolerance * 1000:.2f} mm are allowed."
            )
        worst = max(worst, error)
    _check_ends(target.pouring, gammas[Segment.ROTATE_BACK][::-1], back)
    _check_ends(target.pouring, gammas[Segment.POUR], there)
    return worst, _check_profile(target.pouring, gammas[Segment.POUR], there)


def _rotated(target: PourTarget, move: PlannedMove, cups: FloatArray) -> tuple[float, FloatArray]:
    """How far the pivot moves, and gamma (N,); refuses any other rotation."""
    cup, pivot_m, theta_rad = target.pouring.cup, target.pivot_m, target.theta_rad
    ready = cup_pose(cup, pivot_m, theta_rad, 0.0)[:3, :3]
    rotated = np.swapaxes(rotation_z(theta_rad).T @ cups[:, :3, :3] @ ready.T @ rotation_z(theta_rad), 1, 2)
    gamma: FloatArray = np.arctan2(rotated[:, 0, 2], rotated[:, 0, 0])
    ideal = np.zeros_like(rotated)
    ideal[:, 1, 1] = 1
    ideal[:, 0, 0] = ideal[:, 2, 2] = np.cos(gamma)
    ideal[:, 0, 2], ideal[:, 2, 0] = np.sin(gamma), -np.sin(gamma)
    if not np.abs(rotated - ideal).max() <= _ANGLE_RAD:
        raise MotionError(f"In the move '{move.label}' the cup does not rotate about the pour's axis alone.")
    pivots = cups[:, :3, :3] @ pivot_in_cup_m(cup) + cups[:, :3, 3]
    return float(np.linalg.norm(pivots - pivot_m, axis=1).max()), gamma


def _check_ends(pouring: PouringParameters, gamma: FloatArray, move: PlannedMove) -> None:
    ends = gamma[0], gamma[-1] - pouring.gamma_0_rad
    if not np.abs(ends).max() <= _ANGLE_RAD:
        raise MotionError(f"The move '{move.label}' does not rotate the cup by the whole imagined angle.")


def _check_profile(pouring: PouringParameters, gamma: FloatArray, move: PlannedMove) -> float:
    """The rotation's own duration; refuses one that is anywhere faster than the imagined one."""
    times = SAMPLE_S * np.arange(len(gamma))
    imagined = np.array([pour_angle(pouring, time)[0] for time in times])
    rate = np.diff(gamma) / SAMPLE_S
    top = imagined_rate(pouring, np.clip(np.minimum(gamma[1:], gamma[:-1]), 0, None))
    ahead = (gamma > imagined + _ANGLE_RAD).any()
    if ahead or not (rate <= top * (1 + _RATE_SHARE) + _RATE_RAD_S).all():
        raise MotionError(f"In the move '{move.label}' the cup rotates faster than imagined.")
    moving = np.flatnonzero(np.abs(rate) > _RATE_RAD_S * 1e-3)
    starts, ends = moving[0], moving[-1] + 1
    if starts * SAMPLE_S < pouring.settle_s - SAMPLE_S or times[-1] - times[ends] < pouring.wait_s - SAMPLE_S:
        raise MotionError(f"In the move '{move.label}' the cup is not at rest as long as imagined.")
    return float(times[ends] - times[starts])
