"""Points as a measuring machine would take them on a repaired blade of examples/blisk-19. It shares nothing with the planner.

The blade is NACA 65-010 on circular arcs, laid on cylinders (docs/plan.md, generated rotors). Its pressure side stands 0.05 mm above the nominal surface; a
weld 0.9 mm high covers it above a line from 55 % of the height at the leading edge to 75 % at the trailing edge. Noise: 5 um. Prints the table; an argument
asks for about as many points, spread in the same way, instead of 4028.

With the argument "edge" a weld 0.8 mm high lies over the leading edge instead (edge.csv): about 60 % of the height, 4.5 mm up and down, 5 mm along the
pressure and 4 mm along the suction side, which stand 0.05 and 0.03 mm above the nominal surface. With "trailing" the same lies over the trailing edge
(trailing.csv).
"""

import sys
from math import acos, asin, cos, pi, radians, sin, sqrt
from random import Random

HALF_PERCENT = [
    (0.0, 0.0), (0.5, 0.772), (0.75, 0.932), (1.25, 1.169), (2.5, 1.574), (5.0, 2.177), (7.5, 2.647), (10.0, 3.040), (15.0, 3.666),
    (20.0, 4.143), (25.0, 4.503), (30.0, 4.760), (35.0, 4.924), (40.0, 4.996), (45.0, 4.963), (50.0, 4.812), (55.0, 4.530), (60.0, 4.146),
    (65.0, 3.682), (70.0, 3.156), (75.0, 2.584), (80.0, 1.987), (85.0, 1.385), (90.0, 0.810), (95.0, 0.306), (100.0, 0.0),
]
HUB_MM, TIP_MM, CHORD_MM = 70.0, 98.6, 26.0
OLD_MM, WELD_MM, RAMP, NOISE_MM = 0.05, 0.9, 0.03, 0.005


def half_thickness(x):
    percent = 100.0 * x
    for (low, below), (high, above) in zip(HALF_PERCENT, HALF_PERCENT[1:]):
        if percent <= high:
            share = (sqrt(percent) - sqrt(low)) / (sqrt(high) - sqrt(low))
            return (below + (above - below) * share) / 100.0
    return 0.0


def mixed(pair, s):
    return pair[0] + (pair[1] - pair[0]) * s


def surface(side, x, s):
    """Point of the pressure (-1) or suction side (+1) at the share x of the chord and s of the height."""
    camber, stagger = radians(mixed((14.0, 10.0), s)), radians(mixed((28.0, 42.0), s))
    rho = CHORD_MM / (2.0 * sin(camber / 2.0))
    angle = asin(CHORD_MM * (x - 0.5) / rho)
    bow = rho * (cos(angle) - cos(camber / 2.0))
    thick = half_thickness(x) * CHORD_MM * mixed((0.1, 0.055), s) / 0.1
    along = CHORD_MM * (x - 0.5) + side * thick * sin(angle)
    across = -bow - side * thick * cos(angle)
    radius = HUB_MM + (TIP_MM - HUB_MM) * s
    around = (along * sin(stagger) + across * cos(stagger)) / radius
    return radius * cos(around), radius * sin(around), along * cos(stagger) - across * sin(stagger)


def normal(side, x, s):
    """Unit normal away from the blade."""
    h = 1e-5
    a = [(p - q) / (2 * h) for p, q in zip(surface(side, x + h, s), surface(side, x - h, s))]
    b = [(p - q) / (2 * h) for p, q in zip(surface(side, x, s + h), surface(side, x, s - h))]
    n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    # The pressure side faces growing angles about z.
    out = -side * (n[1] * surface(side, x, s)[0] - n[0] * surface(side, x, s)[1])
    length = sqrt(sum(c * c for c in n))
    return [c / length * (1.0 if out > 0.0 else -1.0) for c in n]


def stands_mm(x, s):
    """Height of the pressure side above the nominal surface."""
    t = min(max((s - 0.55 - 0.2 * x) / RAMP, 0.0), 1.0)
    return OLD_MM + (WELD_MM - OLD_MM) * t * t * (3.0 - 2.0 * t)


def main(points):
    random, scale = Random(27), points / 4028
    rows, columns = round(64 * sqrt(scale)), round(52 * sqrt(scale))
    print("# a repaired blade, synthetic (make_points.py)\nside,x_mm,y_mm,z_mm")

    def put(name, point, direction, height):
        height += random.gauss(0.0, NOISE_MM)
        print(name, *(f"{p + d * height:.4f}" for p, d in zip(point, direction)), sep=",")

    # Stratified: one point at random in each cell, as dense as a scanner's after thinning.
    for i in range(rows):
        for j in range(columns):
            x, s = 0.004 + 0.992 * (j + random.random()) / columns, 0.005 + 0.99 * (i + random.random()) / rows
            put("PS", surface(-1, x, s), normal(-1, x, s), stands_mm(x, s))
    for _ in range(round(500 * scale)):
        x, s = random.uniform(0.01, 0.99), random.uniform(0.03, 0.97)
        put("SS", surface(1, x, s), normal(1, x, s), 0.0)
    for _ in range(round(200 * scale)):
        angle, z = random.choice((-1, 1)) * random.uniform(0.1, 0.14), random.uniform(-5.0, 5.0)
        put("HUB", (HUB_MM * cos(angle), HUB_MM * sin(angle), z), (cos(angle), sin(angle), 0.0), 0.0)


def round_edge(t, s):
    """Point and normal of both sides in one over the leading edge, at the share t * t of the chord: pressure side below 0."""
    def at(t, s):
        return surface(-1 if t < 0.0 else 1, t * t, s)
    h = 1e-5
    a = [(p - q) / (2 * h) for p, q in zip(at(t + h, s), at(t - h, s))]
    b = [(p - q) / (2 * h) for p, q in zip(at(t, s + h), at(t, s - h))]
    n = [b[1] * a[2] - b[2] * a[1], b[2] * a[0] - b[0] * a[2], b[0] * a[1] - b[1] * a[0]]
    length = sqrt(sum(c * c for c in n))
    return at(t, s), [c / length for c in n]


def over_edge_mm(along, s):
    """Height of both sides above the nominal surface at a distance from the edge (pressure side below 0), with the weld over the edge."""
    old = 0.04 - 0.01 * min(max(along / 2.0, -1.0), 1.0)
    off = sqrt(((s - 0.6) * (TIP_MM - HUB_MM) / 4.5) ** 2 + (along / (5.0 if along < 0.0 else 4.0)) ** 2)
    ramp = min(max((1.0 - off) * 6.0, 0.0), 1.0)
    return old + (0.8 - old) * ramp * ramp * (3.0 - 2.0 * ramp)


def round_leading(s):
    """Points, normals and distances from the leading edge, from the pressure to the suction side."""
    for k in range(-3990, 3991):
        t = k / 4000
        yield *round_edge(t, s), CHORD_MM * t * abs(t)


def round_trailing(s):
    """The same about the trailing edge, which is sharp: there the direction turns from the normal of one side to that of the other."""
    def on_side(side, k):
        x = 1.0 - k / 4000
        return surface(side, x, s), normal(side, min(x, 1.0 - 2e-5), s), side * CHORD_MM * (1.0 - x)
    yield from (on_side(-1, k) for k in range(3990, -1, -1))
    (tip, first, _), (_, last, _) = on_side(-1, 0), on_side(1, 0)
    whole = acos(sum(a * b for a, b in zip(first, last)))
    for k in range(1, 1000):
        share = k / 1000
        weights = sin((1.0 - share) * whole) / sin(whole), sin(share * whole) / sin(whole)
        yield tip, [weights[0] * a + weights[1] * b for a, b in zip(first, last)], 0.0
    yield from (on_side(1, k) for k in range(3991))


def over_edge(name, round_it, seed, stylus_mm):
    """Points evenly along the path of a stylus with this radius, 0.5 mm apart, within 13 mm of the edge; fewer beyond."""
    random, rows = Random(seed), 64
    print(f"# a blade repaired over its {name} edge, synthetic (make_points.py {sys.argv[1]})\nside,x_mm,y_mm,z_mm")
    for i in range(rows):
        last, so_far, due = None, 0.0, 0.0
        s = 0.005 + 0.99 * (i + 0.5) / rows
        for point, n, along in round_it(s):
            height = over_edge_mm(along, s)
            centre = [p + d * (height + stylus_mm) for p, d in zip(point, n)]
            so_far += sqrt(sum((p - q) ** 2 for p, q in zip(centre, last))) if last else 0.0
            last = centre
            if so_far < due:
                continue
            due = so_far + (0.5 if abs(along) < 12.996 else 1.5) * random.uniform(0.8, 1.2)
            height += random.gauss(0.0, NOISE_MM)
            print("PS" if along < 0.0 else "SS", *(f"{p + d * height:.4f}" for p, d in zip(point, n)), sep=",")


if sys.argv[1:] == ["edge"]:
    over_edge("leading", round_leading, 29, 0.0)
elif sys.argv[1:] == ["trailing"]:
    over_edge("trailing", round_trailing, 31, 0.5)
else:
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 4028)
