#!/usr/bin/env python3
"""Writes the rotor of `rotor.py` in the formats that need no CAD system: `rotor_formats.py FOLDER`."""

import random
import re
import struct
import sys
from math import cos, degrees, pi, sin
from pathlib import Path

from rotor import ENDS_MM, cartesian, edges, hub_mm, polar, sides, tip_mm

SECTIONS = 17
POINTS = 101
SHARES = [k / (SECTIONS - 1) for k in range(SECTIONS)]


def table(header, line, shares=SHARES, fillet_mm=0.0):
    rows = [header]
    for s in shares:
        for side, phis in zip(("PS", "SS"), sides(s, POINTS, fillet_mm)):
            rows += [line(s, side, phi) for phi in phis]
    return "\n".join(rows) + "\n"


def xyz_line(s, side, phi):
    x, y, z = cartesian(s, phi)
    return f"{s:.5f},{side},{x:.7f},{y:.7f},{z:.7f}"


def millimetre_line(s, side, phi):
    z, r, theta = polar(s, phi)
    return f"{s:.5f};{side};{z:.7f};{r:.7f};{degrees(theta):.9f}"


def inch_line(s, side, phi):
    z, r, theta = polar(s, phi)
    return f"{s:.5f}\t{side}\t{z / 25.4:.9f}\t{r / 25.4:.9f}\t{theta:.11f}"


def generatrix(radius):
    places = [ENDS_MM[0] + (ENDS_MM[1] - ENDS_MM[0]) * k / 10.0 for k in range(11)]
    return "".join(f"{radius(z) * cos(0.4):.7f} {radius(z) * sin(0.4):.7f} {z:.7f}\n" for z in places)


def profile():
    text = ""
    for at, s in enumerate(SHARES):
        pressure, suction = sides(s, POINTS)
        text += f"# Profile {at + 1} at {100.0 * s:.4f} %\n"
        around = pressure + suction[-2::-1]
        text += "".join("{:.7f}\t{:.7f}\t{:.7f}\n".format(*cartesian(s, phi)) for phi in around)
    return text


def blade(low, around, up, fillet_mm=0.0):
    """Triangles of the solid from the share `low` of the height to the tip, the corners moved along the surface at random."""
    chance = random.Random(20261125)
    # The ellipse's parameter is dense at the edges by itself.
    rows = []
    for j in range(up + 1):
        row = []
        for i in range(around):
            inner = 0 < j < up
            s = low + (1.0 - low) * (j + (chance.uniform(-0.2, 0.2) if inner else 0.0)) / up
            if fillet_mm > 0.0:
                s = low + (1.0 - low) * (j / up) ** 2
            phi = 2.0 * pi * (i + chance.uniform(-0.2, 0.2)) / around
            row.append(cartesian(s, phi, fillet_mm))
        rows.append(row + [row[0]])
    triangles = []
    for lower, upper in zip(rows, rows[1:]):
        for i in range(around):
            a, b, c, d = lower[i], lower[i + 1], upper[i + 1], upper[i]
            triangles += [(a, b, c), (a, c, d)] if chance.random() < 0.5 else [(a, b, d), (b, c, d)]
    for row, is_top in ((rows[0], False), (rows[-1], True)):
        for i in range(around // 2):
            a, b, c, d = row[i], row[i + 1], row[around - i - 1], row[around - i]
            cap = [(a, b, c), (a, c, d)]
            triangles += cap if is_top else [t[::-1] for t in cap]
    return triangles


def hub():
    """Disc with a bore of 20 mm."""
    count = 240
    ring = lambda r, z: [(r * cos(2 * pi * k / count), r * sin(2 * pi * k / count), z) for k in range(count + 1)]
    low, high = ENDS_MM
    rows = [ring(20.0, low), ring(hub_mm(low), low), ring(hub_mm(high), high), ring(20.0, high), ring(20.0, low)]
    triangles = []
    for lower, upper in zip(rows, rows[1:]):
        for i in range(count):
            triangles += [(lower[i], lower[i + 1], upper[i + 1]), (lower[i], upper[i + 1], upper[i])]
    return triangles


def facets(triangles):
    return [t for t in triangles if t[0] != t[1] and t[1] != t[2] and t[2] != t[0]]


def binary(triangles):
    triangles = facets(triangles)
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *t[0], *t[1], *t[2], 0) for t in triangles)
    return b"a CAD system".ljust(80) + struct.pack("<I", len(triangles)) + body


def ascii_text(triangles):
    lines = ["solid blade"]
    for t in facets(triangles):
        lines += ["  facet normal 0 0 0", "    outer loop"]
        lines += ["      vertex {:.7e} {:.7e} {:.7e}".format(*corner) for corner in t]
        lines += ["    endloop", "  endfacet"]
    return "\n".join(lines + ["endsolid blade"]) + "\n"


def aside(point):
    """A point of the blade's copy that is turned by 20 degrees: a splitter half way between nine blades."""
    x, y, z = point
    return x * cos(pi / 9) - y * sin(pi / 9), x * sin(pi / 9) + y * cos(pi / 9), z


def with_splitter(step):
    """The STEP file with a copy of its red blade, turned and green."""
    # Entities of the blade's shell and of its colour, by their numbers in the file beside this script.
    is_of_blade = lambda number: 16 <= number < 3532 or 3629 <= number <= 3636
    renumbered = lambda found: f"#{int(found[1]) + (10000 if is_of_blade(int(found[1])) else 0)}"

    def turned(found):
        place = aside([float(number) for number in found[2].split(",")])
        return found[1] + ",".join(f"{number:.12f}" for number in place) + "))"

    copies = []
    for statement in step.split(";\n"):
        statement = re.sub(r"\s+", "", statement)
        number = re.match(r"#(\d+)=", statement)
        if number and is_of_blade(int(number[1])):
            copy = re.sub(r"#(\d+)", renumbered, statement).replace("'red'", "'green'")
            copies.append(re.sub(r"((?:CARTESIAN_POINT|DIRECTION)\('',\()([^,()]+,[^,()]+,[^,()]+)\)\)", turned, copy))
    data, rest = step.rsplit("ENDSEC;", 1)
    return data + "".join(copy + ";\n" for copy in copies) + "ENDSEC;" + rest


def main(folder):
    def write(name, content):
        content = content if isinstance(content, bytes) else content.encode()
        (folder / name).write_bytes(content)

    write("table.csv", table("s,side,x_mm,y_mm,z_mm", xyz_line))
    write("polar.csv", "\ufeff" + table("s;side;z_mm;r_mm;theta_deg", millimetre_line))
    write("polar-inch.txt", table("s\tside\tz_in\tr_in\ttheta_rad", inch_line))
    write("hub.curve", generatrix(hub_mm))
    write("shroud.curve", generatrix(tip_mm))
    write("profile.curve", profile())
    main_blade = blade(-0.08, 800, 96)
    write("blade.stl", binary(main_blade))
    write("splitter.stl", binary([[aside(corner) for corner in triangle] for triangle in main_blade]))
    write("rotor.step", step := (Path(__file__).parent / "rotor.step").read_text())
    write("with-splitter.step", with_splitter(step))
    write("blade-ascii.stl", ascii_text(blade(0.0, 480, 72)))
    write("hub.stl", binary(hub()))
    # With a fillet of 2 mm at the root; truth between the sections from its own points.
    write("filleted.stl", binary(blade(0.0, 480, 72, 2.0)))


main(Path(sys.argv[1]))
