"""Paths of the cup as an arm would drive it, made without an arm."""

import numpy as np

from core.geometry import FloatArray, make_pose
from core.imagination.cup import cup_pose, pour_angle, pour_duration_s
from core.parameters.bodies import CupParameters
from core.parameters.imagination import PouringParameters
from hardware.simulation.pour_outcome.driven_path import DrivenPath

CUP = CupParameters()
POURING = PouringParameters()
SAMPLE_S = 0.008
UPRIGHT_RAD = CUP.slant_rad - np.pi / 2
"""gamma at which the cup stands upright."""


def eased(duration_s: float) -> FloatArray:
    """Shares of a way, from rest to rest."""
    n = max(round(duration_s / SAMPLE_S), 1)
    return (1 - np.cos(np.linspace(0, np.pi, n + 1)[1:])) / 2


def path_of(poses: list[FloatArray]) -> DrivenPath:
    return DrivenPath(np.arange(len(poses)) * SAMPLE_S, np.array(poses))


def straight(start: FloatArray, end_m: FloatArray, duration_s: float) -> list[FloatArray]:
    """Carried without turning."""
    way = end_m - start[:3, 3]
    return [make_pose(start[:3, :3], start[:3, 3] + share * way) for share in eased(duration_s)]


def turned(pivot_m: FloatArray, theta_rad: float, gammas_rad: FloatArray) -> list[FloatArray]:
    """Turned about the pivot."""
    return [cup_pose(CUP, pivot_m, theta_rad, gamma) for gamma in gammas_rad]


def pouring_path(
    station_m: FloatArray,
    pivot_m: FloatArray,
    theta_rad: float,
    *,
    carry_s: float = 1.5,
    lay_s: float = 1.5,
    pouring: PouringParameters = POURING,
) -> DrivenPath:
    """Lifted from the station, carried, laid down above the object, lowered, poured, and all the way back.

    Each way from rest to rest takes `carry_s`, laying and rising `lay_s`.
    """
    raised_m = pivot_m + np.array([0, 0, CUP.length_m + 0.02])
    above = cup_pose(CUP, raised_m, theta_rad, UPRIGHT_RAD)
    station = make_pose(above[:3, :3], station_m)
    lifted_m = np.array([*station_m[:2], above[2, 3]])
    poses = [station] * 10
    poses += straight(station, lifted_m, carry_s)
    poses += straight(poses[-1], above[:3, 3], carry_s)
    poses += turned(raised_m, theta_rad, UPRIGHT_RAD * (1 - eased(lay_s)))
    laid = cup_pose(CUP, pivot_m, theta_rad, 0.0)
    poses += straight(poses[-1], laid[:3, 3], carry_s)
    times_s = np.arange(0, pour_duration_s(pouring), SAMPLE_S)
    gammas_rad = np.array([pour_angle(pouring, time_s)[0] for time_s in times_s])
    poses += turned(pivot_m, theta_rad, gammas_rad)
    poured = poses[-1]
    poses += straight(poured, poured[:3, 3] + raised_m - pivot_m, carry_s)
    poses += turned(raised_m, theta_rad, gammas_rad[-1] + eased(lay_s) * (UPRIGHT_RAD - gammas_rad[-1]))
    poses += straight(poses[-1], lifted_m, carry_s)
    poses += straight(poses[-1], station_m, carry_s)
    return path_of(poses)


def tipping_path(pivot_m: FloatArray) -> DrivenPath:
    """A cup held upright above the object tips over, fast and from high above: the shortest pour there is."""
    high_m = pivot_m + np.array([0, 0, CUP.length_m + 0.02])
    gammas_rad = UPRIGHT_RAD + (np.radians(70) - UPRIGHT_RAD) * eased(0.8)
    return path_of(
        turned(high_m, 0.0, np.concatenate([[UPRIGHT_RAD] * 3, gammas_rad, [gammas_rad[-1]] * 40]))
    )
