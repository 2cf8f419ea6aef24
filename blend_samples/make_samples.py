# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the samples of this folder anew: blender --background --factory-startup --python make_samples.py -- [--only NAME...] [SCANS]

SCANS is a folder with bunny_holes.ply and buddha_10k.ply (see README.md); without it only the generated samples are made. The layout that is
drawn on a head is drawn with the add-on in build/stage, which scripts/build makes."""

import argparse
import os
import struct
import sys

import bmesh
import bpy
import numpy
from mathutils import Vector, noise

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
import cat_shape  # noqa: E402
import foot_shape  # noqa: E402
import head_shape  # noqa: E402
import implicit_shapes  # noqa: E402

NECK = -1.40  # where the head's neck ends
GRAIN = 2.0**-13  # of what is two units large


def read_ply(path):
    """Points and triangles of a binary little-endian PLY with float32 positions alone."""
    with open(path, "rb") as file:
        counts = {}
        while (line := file.readline().strip()) != b"end_header":
            words = line.split()
            if words[0] == b"element":
                counts[words[1].decode()] = int(words[2])
        points = numpy.frombuffer(file.read(12 * counts["vertex"]), dtype="<f4").reshape(-1, 3)
        faces = numpy.frombuffer(file.read(13 * counts["face"]), dtype=[("count", "u1"), ("corners", "<i4", 3)])["corners"]
    return points, faces


def write_ply(path, mesh):
    """A triangle mesh as a binary little-endian PLY."""
    with open(path, "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n" % len(mesh.vertices))
        file.write(b"element face %d\nproperty list uchar int vertex_indices\nend_header\n" % len(mesh.polygons))
        for vertex in mesh.vertices:
            file.write(struct.pack("<3f", *vertex.co))
        for polygon in mesh.polygons:
            file.write(struct.pack("<B3i", 3, *polygon.vertices))


def start():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.world = bpy.data.worlds.new("World")


def finish(name, active):
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj == active)
    bpy.context.view_layer.objects.active = active
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(HERE, name + ".blend"), compress=True)
    print(f"{name}.blend: {os.path.getsize(os.path.join(HERE, name + '.blend')) / 1e6:.2f} MB")


def add(name, mesh, material="Clay", color=(0.55, 0.42, 0.33, 1)):
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    if material:
        made = bpy.data.materials.get(material) or bpy.data.materials.new(material)
        made.diffuse_color = color
        mesh.materials.append(made)
    return obj


def thin_out(obj, ratio):
    bpy.context.view_layer.objects.active = obj
    modifier = obj.modifiers.new("Decimate", "DECIMATE")
    modifier.ratio = ratio
    modifier.use_collapse_triangulate = True
    with bpy.context.temp_override(object=obj, active_object=obj):
        bpy.ops.object.modifier_apply(modifier=modifier.name)


def scan(name, path, ratio, axes):
    """A scan, thinned out, two units high, standing on the ground. axes: rows of the rotation that sets it upright."""
    points, faces = read_ply(path)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    obj = add(name, mesh)
    if ratio < 1:
        thin_out(obj, ratio)
    places = numpy.array([vertex.co for vertex in mesh.vertices])
    places = places @ numpy.array(axes, dtype=float).T
    low, high = places.min(0), places.max(0)
    places = (places - [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]]) * (2 / (high[2] - low[2]))
    mesh.vertices.foreach_set("co", places.astype(numpy.float32).ravel())
    mesh.update()
    return obj


def knot(name, along=300, around=28):
    """A trefoil knot whose skin is rough, as if scanned: genus 1, triangles."""
    mesh = bpy.data.meshes.new(name)
    t = numpy.linspace(0, 2 * numpy.pi, along, endpoint=False)

    def curve(t):
        return numpy.stack([numpy.sin(t) + 2 * numpy.sin(2 * t), numpy.cos(t) - 2 * numpy.cos(2 * t), -numpy.sin(3 * t)], axis=1)

    centre = curve(t)
    tangent = curve(t + 1e-4) - curve(t - 1e-4)
    tangent /= numpy.linalg.norm(tangent, axis=1, keepdims=True)
    radial = centre * [1, 1, 0]
    side = numpy.cross(tangent, radial)
    side /= numpy.linalg.norm(side, axis=1, keepdims=True)
    other = numpy.cross(tangent, side)
    points, faces = [], []
    for i in range(along):
        for j in range(around):
            angle = 2 * numpy.pi * (j + 0.5 * (i % 2)) / around
            direction = numpy.cos(angle) * side[i] + numpy.sin(angle) * other[i]
            place = centre[i] + 0.62 * direction
            rough = 0.10 * noise.noise(Vector(place * 1.3)) + 0.04 * noise.noise(Vector(place * 5))
            points.append(tuple(place + rough * direction))
    for i in range(along):
        for j in range(around):
            a, b = i * around + j, i * around + (j + 1) % around
            c, d = (i + 1) % along * around + j, (i + 1) % along * around + (j + 1) % around
            faces += [(a, c, b), (b, c, d)] if i % 2 == 0 else [(a, c, d), (a, d, b)]
    mesh.from_pydata(points, [], faces)
    mesh.update()
    graph = bmesh.new()
    graph.from_mesh(mesh)
    bmesh.ops.recalc_face_normals(graph, faces=graph.faces)
    graph.to_mesh(mesh)
    graph.free()
    return add(name, mesh)


def prism():
    """N-gons that are not convex, and a bevel."""
    mesh = bpy.data.meshes.new("star prism")
    graph = bmesh.new()
    outline = [(numpy.cos(numpy.pi * k / 6) * r, numpy.sin(numpy.pi * k / 6) * r) for k, r in enumerate([1, 0.5] * 6)]
    bottom = [graph.verts.new((x, y, 0)) for x, y in outline]
    top = [graph.verts.new((x, y, 0.6)) for x, y in outline]
    graph.faces.new(bottom[::-1])
    graph.faces.new(top)
    for i in range(12):
        graph.faces.new((bottom[i], bottom[(i + 1) % 12], top[(i + 1) % 12], top[i]))
    graph.to_mesh(mesh)
    graph.free()
    obj = add("Stern ★", mesh)
    bevel = obj.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments = 0.05, 3
    return obj


def ring(name):
    """A coarse cage of quads under a subdivision surface."""
    bpy.ops.mesh.primitive_torus_add(major_segments=8, minor_segments=5, major_radius=1.2, minor_radius=0.5)
    obj = bpy.context.object
    obj.name = obj.data.name = name
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 3
    return obj


def transforms():
    """Everything an object's transform and name can do to a remesher."""
    parent = bpy.data.objects.new("turntable", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.rotation_euler, parent.scale = (0, 0, 0.5), (1.5, 1, 1)
    star = prism()
    star.parent = parent
    mirrored = knot("mirrored", 120, 16)
    mirrored.location, mirrored.scale, mirrored.rotation_euler = (8, 0, 2), (-0.8, 1.4, 0.5), (0.4, 0.1, 0)
    tall = ring("Größe 猫")
    tall.location, tall.scale = (-5, 0, 1), (1, 1, 3)
    return star


def implicit(name, shapes, triangles, grain=None):
    """A smooth mesh of irregular triangles as a scanner gives them. shapes: (distance, low, high, lattice step) of each component.

    grain: coordinates are made multiples of it, which a compressed file is smaller for.
    """
    points, faces = [], []
    for distance, low, high, step in shapes:
        some, corners = implicit_shapes.zero_set(distance, low, high, step)
        faces.append(corners + sum(map(len, points)))
        points.append(implicit_shapes.evened(distance, some, corners, step))
    points, faces = numpy.concatenate(points), numpy.concatenate(faces)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    obj = add(name, mesh)
    thin_out(obj, triangles / len(faces))
    if grain:
        for vertex in mesh.vertices:
            vertex.co = [round(value / grain) * grain for value in vertex.co]
    for polygon in mesh.polygons:
        polygon.use_smooth = True
    return obj


def head(name, triangles, closed):
    """A head whose neck ends in a boundary loop, or in a rounded cap."""
    low, high, step = numpy.array([-1.0, -1.3, NECK]), [1.0, 1.2, 1.2], 0.02

    def distance(points):
        away = head_shape.head(points)
        return implicit_shapes.without(away, points[:, 2] - NECK, 0.1) if closed else away

    return implicit(name, [(distance, low - [0, 0, 4 * step if closed else 0], high, step)], triangles)


def bones(name, shapes, triangles):
    """Bones of the foot, as long as two units from the first to the last, standing on the ground."""
    low, high = numpy.min([low for _, low, _ in shapes], axis=0), numpy.max([high for _, _, high in shapes], axis=0)
    size, middle = 2 / (high - low).max(), [*(low + high)[:2] / 2, 0]

    def placed(distance, low, high):
        step = 0.06 * (high - low).max() ** 0.5 * size
        return lambda points: size * distance(points / size + middle), (low - middle) * size, (high - middle) * size, step

    return implicit(name, [placed(*shape) for shape in shapes], triangles, GRAIN)


def six_quads(obj):
    """Draws the edges of a cube on the closed head: face, back, two sides with an ear each, crown and neck."""
    sys.path.insert(0, os.path.join(HERE, os.pardir, "build", "stage"))
    import hybrid_mesh
    from hybrid_mesh.bridge import strokes
    from hybrid_mesh.features.layouts import properties

    hybrid_mesh.register()
    bpy.ops.hybrid_mesh.draw_layout()
    layout = properties.layout_of(obj, bpy.context.scene)
    top = [(-0.42, -0.52, 0.72), (0.42, -0.52, 0.72), (0.42, 0.72, 0.72), (-0.42, 0.72, 0.72)]
    bottom = [(-0.36, 0.00, -1.36), (0.36, 0.00, -1.36), (0.34, 0.55, -1.36), (-0.34, 0.55, -1.36)]
    ends = [(corners[k], corners[(k + 1) % 4]) for corners in (top, bottom) for k in range(4)] + list(zip(top, bottom))
    for number, (start, end) in enumerate(ends):
        line = []
        for t in numpy.linspace(0, 1, 25):
            place = (1 - t) * numpy.array(start) + t * numpy.array(end)
            # Seen from the head's axis; between jaw and ear the side's lines go around, as a hand would draw them.
            axis = numpy.array([0, 0.1 + 0.15 * max(0, -place[2]), 0.85 * place[2]])
            if number > 7:
                place = place + [numpy.sign(start[0]) * 0.25 * numpy.sin(numpy.pi * t), 0, 0]
            direction = (place - axis) / numpy.linalg.norm(place - axis)
            hit, there, _, _ = obj.ray_cast(Vector(axis + 4 * direction), Vector(-direction))
            assert hit
            line.append(there)
        strokes.write(layout, layout.data.layers.active, bpy.context.scene.frame_current, [numpy.array(line)])
    bpy.ops.object.mode_set(mode="OBJECT")


def main():
    parser = argparse.ArgumentParser(prog="make_samples.py")
    parser.add_argument("scans", nargs="?", help="folder of bunny_holes.ply and buddha_10k.ply")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="make these and no others")
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])

    def wanted(name):
        if arguments.only and name not in arguments.only:
            return False
        start()
        return True

    if arguments.scans and wanted("bunny"):
        bunny = scan("bunny", os.path.join(arguments.scans, "bunny_holes.ply"), 0.45, [[1, 0, 0], [0, 0, 1], [0, -1, 0]])
        write_ply(os.path.join(HERE, "bunny.ply"), bunny.data)
        finish("bunny", bunny)
    if arguments.scans and wanted("buddha"):
        finish("buddha", scan("buddha", os.path.join(arguments.scans, "buddha_10k.ply"), 1, numpy.eye(3)))
    if wanted("knot"):
        finish("knot", knot("knot"))
    if wanted("transforms"):
        finish("transforms", transforms())
    if wanted("tail"):
        finish("tail", implicit("cat", [(cat_shape.cat, [-0.65, -0.95, -0.1], [0.65, 1.8, 2.15], 0.03)], 12_000, GRAIN))
    if wanted("two_bones"):
        finish("two_bones", bones("two bones", foot_shape.two_bones(), 8_000))
    if wanted("foot"):
        finish("foot", bones("foot", foot_shape.foot(), 13_000))
    if wanted("head"):
        finish("head", head("head", 18_000, closed=False))
    if wanted("head_layout"):
        drawn_on = head("head", 12_000, closed=True)
        six_quads(drawn_on)
        finish("head_layout", drawn_on)


main()
