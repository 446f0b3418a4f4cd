"""Answers of other programs to questions about repairs, as JSON; the first argument names the question, the input has its numbers."""

import json
import sys

import numpy


def nearest(given):
    """Distances of points from a mesh, by trimesh."""
    import trimesh

    mesh = trimesh.Trimesh(given["vertices"], given["faces"], process=False)
    return trimesh.proximity.closest_point(mesh, given["points"])[1].tolist()


def signed(given):
    """Distances of points from a mesh with the sign of their side, by libigl."""
    import igl

    corners, faces = numpy.array(given["vertices"]), numpy.array(given["faces"], dtype=numpy.int64)
    sides = igl.SIGNED_DISTANCE_TYPE_PSEUDONORMAL
    return igl.signed_distance(numpy.array(given["points"]), corners, faces, sides)[0].tolist()


def drops(given):
    """Heights of the lowest place of a ball above a mesh, by opencamlib."""
    import opencamlib

    surface = opencamlib.STLSurf()
    corners = given["vertices"]
    for face in given["faces"]:
        surface.addTriangle(opencamlib.Triangle(*[opencamlib.Point(*corners[index]) for index in face]))
    cutter = opencamlib.BallCutter(2.0 * given["radius"], 100.0)
    dropped = opencamlib.BatchDropCutter()
    dropped.setSTL(surface)
    dropped.setCutter(cutter)
    for x, y in given["points"]:
        dropped.appendPoint(opencamlib.CLPoint(x, y, -1000.0))
    dropped.run()
    return [point.z for point in dropped.getCLPoints()]


def step(given):
    """Step of the point-to-plane registration, by Open3D: the upper rows of its matrix."""
    import open3d

    def cloud(points, normals=None):
        made = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(numpy.array(points)))
        if normals is not None:
            made.normals = open3d.utility.Vector3dVector(numpy.array(normals))
        return made

    pairs = open3d.utility.Vector2iVector(numpy.array([[k, k] for k in range(len(given["points"]))], dtype=numpy.int32))
    estimation = open3d.pipelines.registration.TransformationEstimationPointToPlane()
    feet = cloud(given["feet"], given["normals"])
    return estimation.compute_transformation(cloud(given["points"]), feet, pairs)[:3].tolist()


print(json.dumps({"nearest": nearest, "signed": signed, "drops": drops, "step": step}[sys.argv[1]](json.load(sys.stdin))))
