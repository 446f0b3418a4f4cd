"""One rotor in closed form, for `rotor_formats.py` and `rotor_step.py`. It shares nothing with the planner.

A section at the share s of the height is an ellipse on a parabolic camber line, laid on the surface of revolution
r = (1 - s) r_hub(z) + s r_tip(z). Angles about the axis in rad, lengths in mm.
"""

from math import cos, hypot, pi, sin, sqrt, tan, radians

BLADES = 19
TIP_MM = 98.6
CHORD_MM = 24.0
ENDS_MM = (-20.0, 20.0)


def hub_mm(z):
    return 70.0 + 0.03 * z


def tip_mm(z):
    return TIP_MM


def mixed(pair, s):
    return pair[0] + (pair[1] - pair[0]) * s


def polar(s, phi, fillet_mm=0.0):
    """(z, r, theta) of the outline's point phi: 0 and pi at the ends of the chord, sin(phi) > 0 on the convex side."""
    thickness = mixed((3.2, 2.2), s)
    height = (TIP_MM - 70.0) * s
    x = CHORD_MM / 2.0 * cos(phi)
    y = mixed((1.4, 1.0), s) * sin(phi) ** 2 + thickness / 2.0 * sin(phi)
    if fillet_mm > 0.0 and height < fillet_mm:
        # A quarter of a circle beside the wall, along the outline's normal.
        wide = fillet_mm - sqrt(fillet_mm**2 - (fillet_mm - max(height, 0.0)) ** 2)
        dx = -CHORD_MM / 2.0 * sin(phi)
        dy = mixed((1.4, 1.0), s) * 2.0 * sin(phi) * cos(phi) + thickness / 2.0 * cos(phi)
        x, y = x + wide * dy / hypot(dx, dy), y - wide * dx / hypot(dx, dy)
    stagger = radians(mixed((28.0, 42.0), s))
    z = x * cos(stagger) + y * sin(stagger)
    around = x * sin(stagger) - y * cos(stagger)
    r = (1.0 - s) * hub_mm(z) + s * tip_mm(z)
    return z, r, around / r


def cartesian(s, phi, fillet_mm=0.0):
    z, r, theta = polar(s, phi, fillet_mm)
    return r * cos(theta), r * sin(theta), z


def edges(s, fillet_mm=0.0):
    """phi of the two points of a section that lie farthest apart, the one at low z first."""
    def apart(a, b):
        return sum((p - q) ** 2 for p, q in zip(cartesian(s, a, fillet_mm), cartesian(s, b, fillet_mm)))

    low, high, step = pi, 0.0, 0.05
    while step > 1e-9:
        tries = [(apart(low + i * step, high + j * step), low + i * step, high + j * step) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        best = max(tries)
        if (best[1], best[2]) == (low, high):
            step /= 2.0
        low, high = best[1], best[2]
    return low, high


def by_length(s, first, last, shares, fillet_mm):
    """phi at shares of the length of the outline between two phi."""
    steps = 4000
    phis = [first + (last - first) * k / steps for k in range(steps + 1)]
    points = [cartesian(s, phi, fillet_mm) for phi in phis]
    lengths = [0.0]
    for a, b in zip(points, points[1:]):
        lengths.append(lengths[-1] + sqrt(sum((p - q) ** 2 for p, q in zip(a, b))))
    found, at = [], 0
    for share in shares:
        wanted = share * lengths[-1]
        while at < steps - 1 and lengths[at + 1] < wanted:
            at += 1
        found.append(phis[at] + (phis[at + 1] - phis[at]) * (wanted - lengths[at]) / (lengths[at + 1] - lengths[at]))
    return found


def sides(s, count, fillet_mm=0.0):
    """phi of both sides from the leading (low z) to the trailing edge: pressure, suction. Dense at the edges, by length: the points of
    one number lie at the same share of every section, as in the tables of most programs."""
    low, high = edges(s, fillet_mm)
    shares = [(1.0 - cos(pi * k / (count - 1))) / 2.0 for k in range(count)]
    suction = by_length(s, low, high, shares, fillet_mm)
    pressure = by_length(s, low, high + 2.0 * pi, shares, fillet_mm)
    return pressure, suction
