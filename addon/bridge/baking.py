# SPDX-License-Identifier: GPL-3.0-or-later
"""Images baked by Cycles in a scene of its own: what else there is neither shows in them nor changes."""

import contextlib
import math

import bpy
import numpy

from .. import compat
from . import meshes
from .arrays import world_matrix

_SHARP = math.radians(40)  # as the angle of Sharp Edges is at first
_FLAT = 0.5  # what 0 is in an image that has numbers from -1 to 1


class BakeError(ValueError):
    """Blender has not baked; the message says why."""


@contextlib.contextmanager
def bench(context):
    """Gives a Bench, and takes away all that it needs."""
    one = Bench(context)
    try:
        yield one
    finally:
        one.clear()


class Bench:
    """A scene in which objects are baked. Surfaces to bake from are copies, so that it does not matter where theirs are hidden."""

    def __init__(self, context):
        self._context = context
        self._made = []
        self._scene = bpy.data.scenes.new("bake")
        try:
            self._scene.render.engine = "CYCLES"
        except TypeError as error:
            bpy.data.scenes.remove(self._scene)
            raise BakeError("images are baked by Cycles, which is not there: enable the add-on Cycles Render Engine") from error
        self._scene.cycles.samples = 1
        self._scene.cycles.device = "CPU"
        self._scene.cycles.use_denoising = False

    def clear(self):
        for block, collection in reversed(self._made):
            collection.remove(block)
        bpy.data.scenes.remove(self._scene)

    def surface(self, mesh, matrix, smooth=False):
        """An object of a mesh, which goes with the bench, to bake from. smooth: if it is shaded flat everywhere, its normals are interpolated, but for sharp edges."""
        self._made.append((mesh, bpy.data.meshes))
        mesh.materials.clear()
        if smooth and not meshes.values_of(mesh.polygons, "use_smooth", 1, bool).any():
            mesh.polygons.foreach_set("use_smooth", numpy.ones(len(mesh.polygons), dtype=bool))
            compat.split_normals_above(mesh, _SHARP)
            mesh.update()
        obj = bpy.data.objects.new("bake", mesh)
        self._made.append((obj, bpy.data.objects))
        obj.matrix_world = matrix
        return obj

    def image(self, name, size):
        """A float image that goes with the bench."""
        image = bpy.data.images.new(name, size, size, alpha=True, float_buffer=True, is_data=True)
        self._made.append((image, bpy.data.images))
        return image

    def show(self, obj, output, scale, offset):
        """Has a surface show an output of Blender's Geometry node (`Position`, `Normal`) as colours: value * scale + offset."""
        material = compat.new_material("bake")
        self._made.append((material, bpy.data.materials))
        nodes, links = material.node_tree.nodes, material.node_tree.links
        nodes.clear()
        entry, map_values = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeVectorMath")
        emission, leave = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
        map_values.operation = "MULTIPLY_ADD"
        map_values.inputs[1].default_value, map_values.inputs[2].default_value = scale, offset
        links.new(entry.outputs[output], map_values.inputs[0])
        links.new(map_values.outputs[0], emission.inputs["Color"])
        links.new(emission.outputs[0], leave.inputs["Surface"])
        obj.data.materials.clear()
        obj.data.materials.append(material)

    def cage(self, obj, far):
        """An object around another one, so far from it in the world. Rays start there; where Blender extrudes by itself they pass by what is scaled unevenly."""
        mesh = obj.data.copy()
        self._made.append((mesh, bpy.data.meshes))
        matrix = world_matrix(obj.matrix_world)
        normals = meshes.values_of(mesh.vertices, "normal", 3).astype(numpy.float64) @ numpy.linalg.inv(matrix[:3, :3])
        normals *= far / numpy.maximum(numpy.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        places = meshes.in_world(meshes.values_of(mesh.vertices, "co", 3), matrix) + normals
        meshes.set_places(mesh, meshes.in_object(places, matrix))
        cage = bpy.data.objects.new("bake cage", mesh)
        self._made.append((cage, bpy.data.objects))
        cage.matrix_world = obj.matrix_world
        return cage

    def bake(self, kind, obj, image, high=None, far=0.0, margin=0):
        """Bakes `kind` (as bpy.ops.object.bake() has it) into an image by the active UV map of an object that has one material; of another object's surface, if there is one.

        far: how far outside the object rays start, and how far inside they end, in the world. Raises BakeError.
        """
        nodes = obj.data.materials[0].node_tree.nodes
        target = nodes.new("ShaderNodeTexImage")
        target.image = image
        before, nodes.active = nodes.active, target
        chosen = [obj] if high is None else [high, obj]
        cage = None if high is None else self.cage(obj, far)
        linked = self._scene.collection.objects
        for one in (*chosen, cage) if cage else chosen:
            linked.link(one)
        layer = self._scene.view_layers[0]
        try:
            for one in chosen:
                one.hide_render = False
                one.select_set(True, view_layer=layer)
            layer.objects.active = obj
            layer.update()
            with self._context.temp_override(
                scene=self._scene, view_layer=layer, object=obj, active_object=obj, selected_objects=chosen, selected_editable_objects=chosen
            ):
                result = bpy.ops.object.bake(
                    type=kind, use_selected_to_active=high is not None, use_cage=cage is not None, cage_object=cage.name if cage else "",
                    max_ray_distance=2 * far, margin=margin, margin_type="EXTEND", use_clear=True, normal_space="TANGENT", target="IMAGE_TEXTURES",
                )  # fmt: skip
            if result != {"FINISHED"}:
                raise BakeError(f"Blender has not baked {image.name}")
        except RuntimeError as error:
            raise BakeError(" ".join(str(error).split())) from error
        finally:
            for one in (*chosen, cage) if cage else chosen:
                linked.unlink(one)
            nodes.remove(target)
            nodes.active = before


def pixels_of(image):
    """(height, width, 4) numbers."""
    values = numpy.empty(image.size[0] * image.size[1] * 4, dtype=numpy.float32)
    image.pixels.foreach_get(values)
    return values.reshape(image.size[1], image.size[0], 4)


def set_pixels(image, values):
    image.pixels.foreach_set(numpy.ascontiguousarray(values, dtype=numpy.float32).ravel())
    image.update()


def heights(bench, low, high, size, far):
    """How far a surface lies beyond that of an object, along its normal in the world, by the pixels of the active UV map: (size, size), and whether anything is known
    there. The materials of both are exchanged meanwhile. Raises BakeError."""
    corners = numpy.array([one.matrix_world @ vertex.co for one in (low, high) for vertex in one.data.vertices], dtype=numpy.float64)
    least, span = corners.min(axis=0), max(float(numpy.ptp(corners, axis=0).max()), 1e-30)
    own = list(low.data.materials)
    images = [bench.image(name, size) for name in ("here", "there", "normals")]
    try:
        scale, offset = (1 / span,) * 3, tuple(-least / span)
        bench.show(low, "Position", scale, offset)
        bench.bake("EMIT", low, images[0])
        bench.show(high, "Position", scale, offset)
        bench.bake("EMIT", low, images[1], high, far)
        bench.show(low, "Normal", (_FLAT,) * 3, (_FLAT,) * 3)
        bench.bake("EMIT", low, images[2])
    finally:
        low.data.materials.clear()
        for material in own:
            low.data.materials.append(material)
    here, there, normals = (pixels_of(image).astype(numpy.float64) for image in images)
    # What a ray has not found is black, which is the corner of the bounding box: no place of a surface, or none that matters.
    known = (here[..., 3] > 0) & there[..., :3].any(axis=-1)
    along = ((there - here)[..., :3] * (normals[..., :3] / _FLAT - 1)).sum(axis=-1) * span
    return numpy.where(known, along, 0.0), known


def grown(values, known, steps):
    """Values of pixels with those of their neighbours where they are not known, so many pixels far."""
    for _ in range(steps):
        total, count = numpy.zeros_like(values), numpy.zeros(values.shape)
        for axis in (0, 1):
            for step in (1, -1):
                total += numpy.roll(numpy.where(known, values, 0), step, axis)
                count += numpy.roll(known, step, axis)
        fresh = ~known & (count > 0)
        values = numpy.where(fresh, total / numpy.maximum(count, 1), values)
        known = known | fresh
    return values
