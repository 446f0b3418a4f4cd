"""Feed per tooth at the centre by the thesis's own equations (Petean 2004, ch. 5, eqs 11-26), in NumPy and float64.

All vectors in the frame of the rotation centre A. The equations are those of the source with its errata corrected: B is the
intersection with u.(A - O) >= 0 and an advancing edge (of two the one with the thicker chip), O' the forward one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def step_per_tooth(
    angle: Array,
    turn: int,
    radii: tuple[float, float],
    edge: int,
    chip: float,
    line: tuple[float, float],
) -> tuple[Array, Array]:
    """Path of the centre per tooth, and the contact angle (rad), at angles of O about A (rad).

    ``turn`` is +1 counter-clockwise, ``radii`` are rho and r0, ``edge`` is k, ``line`` has the angle of the normal (rad) and the
    offset. NaN where there is no admissible contact, or no O'.
    """
    rho, r0 = radii
    normal_angle, offset = line
    normal = np.array([np.cos(normal_angle), np.sin(normal_angle)])
    tangent = np.array([-normal[1], normal[0]])
    center = rho * np.stack([np.cos(angle), np.sin(angle)])
    motion = turn * np.stack([-np.sin(angle), np.cos(angle)])
    with np.errstate(invalid="ignore"):
        # Circle (O, r0) and stock line: eqs 11-16.
        distance = offset - normal @ center
        half_chord = np.sqrt(r0**2 - distance**2)
        best = np.full(angle.shape, np.nan)
        contact = np.full(angle.shape, np.nan)
        for sign in (1.0, -1.0):
            u = (distance * normal[:, None] + sign * half_chord * tangent[:, None]) / r0
            towards = -(u * center).sum(0) / rho
            advance = edge * (u * motion).sum(0)
            admissible = (towards >= 0.0) & (advance > 0.0)
            # C, through which the circle passes one tooth later: eqs 17, 18.
            c = center + (r0 + edge * chip) * u
            # O' on (A, rho) and at the distance r0 from C: eqs 19-23.
            d2 = (c * c).sum(0)
            along = (rho**2 - r0**2 + d2) / (2.0 * np.sqrt(d2))
            across = np.sqrt(rho**2 - along**2)
            unit = c / np.sqrt(d2)
            for side in (1.0, -1.0):
                new = along * unit + side * across * np.stack([-unit[1], unit[0]])
                sine = turn * (center[0] * new[1] - center[1] * new[0])
                # The chord s and the turn alpha: eq. 26.
                chord = np.sqrt(((new - center) ** 2).sum(0))
                path = rho * np.arccos(1.0 - chord**2 / (2.0 * rho**2))
                takes = admissible & (sine > 0.0) & ~(best <= path)
                best = np.where(takes, path, best)
                contact = np.where(takes, np.arctan2(advance, towards), contact)
    return best, contact
