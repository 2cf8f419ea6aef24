# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: pictures of several tiles, each with meshes and curves of its own and a line below it."""

import os

import bmesh
import bpy
import levels_picture as picture
import mathutils
import numpy

REGION, BUFFER = numpy.array([0.82, 0.30, 0.24]), numpy.array([0.93, 0.76, 0.36])
INK, STROKE = (0.03, 0.035, 0.05, 1), (0.01, 0.08, 0.60, 1)
STEP = 2.3  # between the middles of two tiles; what is shown in one is two units large
TEXT = 0.14  # room for a line below a tile, of STEP
LETTER = 0.17  # height of a line of text


def coordinates(mesh):
    return numpy.array([vertex.co for vertex in mesh.vertices])


def quads_of(mesh):
    return numpy.array([polygon.vertices for polygon in mesh.polygons])


def corner_uv(mesh):
    return numpy.array([one.uv for one in mesh.uv_layers["patches"].data])


def attribute(mesh, name):
    from hybrid_mesh.bridge import meshes

    return meshes.get_attribute(mesh, name)


def stretched(mesh):
    """The colours of a level's stretch, a row a face."""
    from hybrid_mesh.core import colors

    return colors.stretch_colors(attribute(mesh, "stretch"))[:, :3]


def grey(mesh):
    return numpy.repeat(picture.GREY[None], len(mesh.polygons), axis=0)


def levels_of(hierarchy):
    return {obj.hybrid_mesh.level: obj for obj in hierarchy.objects if obj.hybrid_mesh.role == "LEVEL"}


def cells(mesh, root_levels, level):
    """Which quad of a coarser level each face of a fine one lies in. root_levels: {root: level}."""
    roots, paths = attribute(mesh, "root"), attribute(mesh, "path").astype(numpy.int64)
    depth = numpy.array([int(path).bit_length() // 2 for path in paths])
    above = numpy.maximum(0, depth - (level - numpy.array([root_levels[int(root)] for root in roots])))
    return roots.astype(numpy.int64) << 32 | paths >> 2 * above


def borders(mesh, cell):
    """Whether the edge from each corner to the next divides cells or is a boundary."""
    sides = {}
    for polygon in mesh.polygons:
        for k in range(4):
            sides[polygon.vertices[k], polygon.vertices[(k + 1) % 4]] = cell[polygon.index]
    return numpy.array([sides.get((b, a)) != sides[a, b] for a, b in sides])


def part(mesh, faces):
    """A mesh of some of a mesh's faces, in their order."""
    kept = numpy.unique(numpy.concatenate([mesh.polygons[face].vertices for face in faces]))
    number = {int(vertex): place for place, vertex in enumerate(kept)}
    made = bpy.data.meshes.new("part")
    made.from_pydata([mesh.vertices[int(vertex)].co for vertex in kept], [], [[number[vertex] for vertex in mesh.polygons[face].vertices] for face in faces])
    return made


def view(turn, tilt=0.0):
    """The rotation (3, 3) of what is turned about the vertical, then tilted toward the camera, in radians."""
    cos, sin, low, high = numpy.cos(turn), numpy.sin(turn), numpy.cos(tilt), numpy.sin(tilt)
    return numpy.array([[1, 0, 0], [0, low, -high], [0, high, low]]) @ numpy.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])


def tubes(lines, radius, ink):
    curve = bpy.data.curves.new("tubes", "CURVE")
    curve.dimensions, curve.bevel_depth, curve.use_fill_caps = "3D", radius, True
    curve.materials.append(ink)
    for line in lines:
        spline = curve.splines.new("POLY")
        spline.points.add(len(line) - 1)
        spline.points.foreach_set("co", numpy.concatenate([line, numpy.ones((len(line), 1))], axis=1).ravel())
    return curve


def balls(places, radius, ink):
    graph = bmesh.new()
    for place in places:
        made = bmesh.ops.create_icosphere(graph, subdivisions=2, radius=radius)
        bmesh.ops.translate(graph, verts=made["verts"], vec=place)
    mesh = bpy.data.meshes.new("balls")
    graph.to_mesh(mesh)
    graph.free()
    mesh.materials.append(ink)
    return mesh


class Tile:
    """A text of one line or more, and data-blocks in one space. `around`: (n, 3) points of that space which the tile is filled by."""

    def __init__(self, text, blocks, around):
        self.text, self.blocks, self.around = text, blocks, around


class Sheet:
    """The materials of a picture's tiles, and the picture."""

    def __init__(self):
        self.quads = picture.material()
        self.ink, self.stroke = picture.plain_material("Ink", INK), picture.plain_material("Strokes", STROKE)

    def shown(self, mesh, size=2.0, **how):
        """A copy of a mesh with lines; how: what picture.display_mesh takes. size: what is shown of it in a tile."""
        made = picture.display_mesh(mesh.name, mesh, size, **how)
        made.materials.append(self.quads)
        return made

    def render(self, tiles, columns, path, samples=None, scene_path=None, rotation=view(picture.TURN), percent=100, wide=1.0, high=1.0):
        """Puts tiles side by side, each with this rotation, and renders them, at a percentage of the full size; saves the scene if asked.

        wide, high: of a tile, for what is taller than wide or wider than tall.
        """
        scene = bpy.context.scene
        for obj in scene.objects:
            obj.hide_render = True
            obj.hide_set(True)
        collection, rows = self._arranged(tiles, columns, rotation, wide, high)
        picture.light_and_camera(collection, columns, rows, STEP, wide, high)
        scene.cycles.samples = samples or picture.SAMPLES
        scene.render.resolution_percentage = percent
        scene.render.filepath = os.path.abspath(path)
        bpy.ops.render.render(write_still=True)
        if scene_path:
            bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(scene_path), compress=True)

    def _arranged(self, tiles, columns, rotation, wide, high):
        collection = bpy.data.collections.new("Side by side")
        bpy.context.scene.collection.children.link(collection)
        rows = -(-len(tiles) // columns)
        angles = mathutils.Matrix(rotation.tolist()).to_euler()
        for number, tile in enumerate(tiles):
            x, z = (number % columns - (columns - 1) / 2) * wide * STEP, ((rows - 1) / 2 - number // columns) * (high + TEXT) * STEP
            around = tile.around @ rotation.T
            size = 2.0 / numpy.ptp(around[:, [0, 2]], axis=0).max()
            middle = size * (around.min(axis=0) + around.max(axis=0)) / 2
            for block in tile.blocks:
                obj = bpy.data.objects.new(tile.text.replace("\n", ", "), block)
                obj.rotation_euler, obj.scale = angles, (size, size, size)
                obj.location = (x - middle[0], -middle[1], z - middle[2])
                collection.objects.link(obj)
            lines = tile.text.count("\n")  # above the last one, which stays where a single one is
            collection.objects.link(picture.label(tile.text, (x, -4, z - (high / 2 + 0.06) * STEP + LETTER * lines), LETTER, self.ink))
        return collection, rows
