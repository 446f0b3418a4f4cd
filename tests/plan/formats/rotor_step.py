#!/usr/bin/env python3
"""Writes `rotor.step` with OpenCASCADE (`pip install cadquery-ocp`): the rotor of `rotor.py` as B-spline faces, named and coloured, and
its hub as a cone. Run by hand; the file lies beside this script."""

import sys
from pathlib import Path

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.GeomAPI import GeomAPI_PointsToBSplineSurface
from OCP.IFSelect import IFSelect_RetDone
from OCP.Interface import Interface_Static
from OCP.Quantity import Quantity_Color, Quantity_TOC_RGB
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.collections import Array2_gp_Pnt
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool
from OCP.gp import gp_Ax3, gp_Dir, gp_Pnt
from OCP.Geom import Geom_ConicalSurface
from math import atan

from rotor import ENDS_MM, cartesian, hub_mm, sides

# The face begins below the hub and ends above the tip.
SHARES = [-0.12 + 1.24 * k / 12 for k in range(13)]
POINTS = 101


def blade():
    """One face around the blade, periodic: an end of the interpolation at an edge would be less exact."""
    grid = Array2_gp_Pnt(1, 2 * (POINTS - 1), 1, len(SHARES))
    for j, s in enumerate(SHARES):
        pressure, suction = sides(s, POINTS)
        for i, phi in enumerate(suction + pressure[-2:0:-1]):
            grid.SetValue(i + 1, j + 1, gp_Pnt(*cartesian(s, phi)))
    surface = GeomAPI_PointsToBSplineSurface()
    surface.Interpolate(grid, True)
    return BRepBuilderAPI_MakeFace(surface.Surface(), 1e-6).Face()


def hub():
    low, high = ENDS_MM
    slope = (hub_mm(high) - hub_mm(low)) / (high - low)
    cone = Geom_ConicalSurface(gp_Ax3(gp_Pnt(0, 0, low), gp_Dir(0, 0, 1)), atan(slope), hub_mm(low))
    return BRepBuilderAPI_MakeFace(cone, 0.0, 1.0, 0.0, (high - low) * (1 + slope * slope) ** 0.5, 1e-6).Face()


document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
for name, shape, colour in (
    ("BLADE", blade(), (1.0, 0.0, 0.0)),
    ("HUB", hub(), (0.0, 0.0, 1.0)),
):
    label = shapes.AddShape(shape, False)
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name))
    colours.SetColor(label, Quantity_Color(*colour, Quantity_TOC_RGB), XCAFDoc_ColorType.XCAFDoc_ColorSurf)
Interface_Static.SetCVal_s("write.step.schema", "AP214IS")
writer = STEPCAFControl_Writer()
writer.SetNameMode(True)
writer.SetColorMode(True)
writer.Transfer(document)
path = Path(sys.argv[1])
assert writer.Write(str(path)) == IFSelect_RetDone
