"""Largest tools of the 19-blade rotor, by nothing but its formulas: needs numpy and scipy. Prints `largest_tool.csv`.

Sections: NACA 65-010 thickness on circular arcs, laid on cylinders (docs/plan.md, "Generated rotors"). Blades: 320 x 400 points of each side and the tip face
in a k-d tree. Walls: bisection on every 0.4 mm of radius. Lines of least greatest gap: linear program (HiGHS).
"""
import numpy as np
from scipy.optimize import linprog
from scipy.spatial import cKDTree

HUB, TIP, ALLOWANCE, PITCH = 70.0, 98.6, 0.889, 2 * np.pi / 19
HALF_PERCENT = np.array([
    (0, 0), (0.5, 0.772), (0.75, 0.932), (1.25, 1.169), (2.5, 1.574), (5, 2.177), (7.5, 2.647), (10, 3.040), (15, 3.666), (20, 4.143), (25, 4.503),
    (30, 4.760), (35, 4.924), (40, 4.996), (45, 4.963), (50, 4.812), (55, 4.530), (60, 4.146), (65, 3.682), (70, 3.156), (75, 2.584), (80, 1.987),
    (85, 1.385), (90, 0.810), (95, 0.306), (100, 0)])


def section(share, count):
    chord, radius = 26.0, HUB + (TIP - HUB) * share
    stagger, camber = np.radians(28 + 14 * share), np.radians(14 - 4 * share)
    station = (1 - np.cos(np.pi * np.arange(count) / (count - 1))) / 2
    arc = chord / (2 * np.sin(camber / 2))
    sin = chord * (station - 0.5) / arc
    cos = np.sqrt(1 - sin * sin)
    height = arc * (cos - np.cos(camber / 2))
    half = np.interp(np.sqrt(100 * station), np.sqrt(HALF_PERCENT[:, 0]), HALF_PERCENT[:, 1]) / 10 * chord * (0.1 - 0.045 * share)
    sides = []
    for sign in (1, -1):
        u, v = chord * (station - 0.5) + sign * half * sin, -height - sign * half * cos
        angle = (u * np.sin(stagger) + v * np.cos(stagger)) / radius
        sides.append(np.c_[radius * np.cos(angle), radius * np.sin(angle), u * np.cos(stagger) - v * np.sin(stagger)])
    return sides


def blade():
    points = [side for share in np.linspace(0, 1, 320) for side in section(share, 400)]
    one, other = section(1.0, 400)
    return np.vstack(points + [one + (other - one) * share for share in np.linspace(0, 1, 14)])


TREE = cKDTree(blade())


def walls(z, distance):
    radii = np.arange(HUB + ALLOWANCE, TIP + distance, 0.4)

    def beyond(angle):
        return TREE.query(np.c_[radii * np.cos(angle), radii * np.sin(angle), np.full(len(radii), z)])[0] - distance

    grid = np.linspace(-0.8 * PITCH, 0.8 * PITCH, 97)
    behind = np.array([beyond(np.full(len(radii), angle)) < 0 for angle in grid])
    found = []
    for sign in (1, -1):
        order = behind[::-1] if sign > 0 else behind
        index = np.argmax(order, axis=0)
        inside = grid[::-1][index] if sign > 0 else grid[index]
        outside = inside + sign * (grid[1] - grid[0])
        for _ in range(26):
            middle = (inside + outside) / 2
            is_in = beyond(middle) < 0
            inside, outside = np.where(is_in, middle, inside), np.where(is_in, outside, middle)
        found.append(np.where(behind.any(axis=0), outside, np.nan))
    return radii, found[0], found[1] + PITCH


def room(z, radius):
    radii, left, right = walls(z, radius + ALLOWANCE)
    known = ~np.isnan(left)
    half = (HUB + ALLOWANCE + TIP) / 2
    middle = (np.interp(half, radii[known], left[known]) + np.interp(half, radii[known], right[known])) / 2
    ends = []
    for angle, sign in ((left, 1), (right, -1)):
        x, y = (sign * radii * np.sin(angle - middle))[known], (radii * np.cos(angle - middle))[known]
        counted = radii[known] <= TIP
        above = np.c_[-np.ones_like(y), -y, np.zeros_like(y)]
        within = np.c_[np.ones(counted.sum()), y[counted], -np.ones(counted.sum())]
        limits = np.r_[-x, x[counted]]
        a, b, _ = linprog([0, 0, 1], A_ub=np.vstack([above, within]), b_ub=limits, bounds=[(None, None)] * 3, method="highs").x
        ends.append([sign * (a + b * (np.sqrt(r * r * (1 + b * b) - a * a) - a * b) / (1 + b * b)) for r in (TIP, HUB + ALLOWANCE)])
    return min(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]), np.nanmin((right - left) * radii)


print("z_mm,R_max_mm,file_R_max_mm,file_free_mm")
for z, file in ((-9, 8.997034072876), (-6, 8.550989151001), (-3, 8.364805221558), (3, 8.262586593628)):
    low, high = file, file + 0.3
    while high - low > 0.001:
        middle = (low + high) / 2
        low, high = (middle, high) if room(z, middle)[0] >= 0 else (low, middle)
    print(f"{z},{low:.4f},{file},{room(z, file)[1]:.3f}")
