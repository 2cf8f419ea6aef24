# SPDX-License-Identifier: GPL-3.0-or-later
"""A level with a material and images that have the details of a finer surface: of the scan, or of what was sculpted on Multires."""

import math
from dataclasses import dataclass, field

import bpy
import numpy

from ... import compat
from ...bridge import arrays, baking, meshes, objects
from ...core.native import native
from ..levels import kept, made
from ..levels.properties import origin_of, report_of
from ..multires import conversion

SUFFIX = "_bake"
LEAST_SIZE, MOST_SIZE = 64, 16384
_ISLAND_MARGIN = 0.02  # of an island's cell, on every side: what the patches' UV map has
_LEAST_GAP = 1.0  # pixels around an island: bilinear filtering takes in half of one
_AUTOMATIC_CELL = 96  # pixels that an island's cell has where the size is automatic
_AUTOMATIC_SIZES = (1024, 4096)
_MOST_EXTRUSION = 0.05  # of the diagonal: handles that open on finer levels lie farther away, and rays from there would meet other parts
_ROOM = 1.25  # times the Hausdorff distance
_SAMPLES = 20000


@dataclass
class Settings:
    level: str = ""  # its name; empty: the one that the preview shows, or of Multires the mesh itself
    source: str = "SCAN"  # or MULTIRES
    size: int = 0  # pixels; 0: by the number of patches
    displacement: bool = False
    floats: bool = False  # 32 bits a number for normals, too
    smooth: bool = True  # a scan that is flat everywhere has its normals interpolated


@dataclass
class Baked:
    obj: bpy.types.Object
    level: str
    images: list = field(default_factory=list)  # normals, then displacement where asked for
    far: float = 0.0  # how far from it rays start, in the world

    def line(self):
        """One line for people."""
        size = self.images[0].size[0]
        kinds = "normals and displacement" if len(self.images) > 1 else "normals"
        return f"{self.obj.name}: {kinds} on {self.level}, {size} x {size} pixels, from up to {self.far:.3g} away"


def bake(context, collection, settings):
    """Makes the object of a level with baked images; returns Baked. Raises ValueError with a line for people, and the native errors; then nothing is left behind."""
    at_hand = kept.at_hand(collection)
    source, sculpted = _source(context, collection, settings)
    level = _level(collection, settings, sculpted)
    name = level.hybrid_mesh.level
    arrays_of_level = at_hand.hierarchy.level(name)
    if not numpy.array_equal(meshes.mesh_arrays(level.data).offsets, arrays_of_level["offsets"]):
        raise ValueError(f"{level.name} has other faces than its level: reset or remesh it")
    side = _islands_a_side(arrays_of_level)
    size = _image_size(settings.size, side)
    # Pixels around an island are filled up to the middle between it and the next one, and one more.
    margin = math.ceil(size / side * _ISLAND_MARGIN) + 1
    blocks = []
    obj = made.make_object(context, collection, level.data.copy(), SUFFIX, name)
    try:
        context.view_layer.update()
        _use_patches(obj.data, arrays_of_level, at_hand.matrix)
        _give_material(obj, blocks)
        with baking.bench(context) as bench:
            high = _surface(context, bench, source, settings.smooth and not sculpted)
            far = _distance(collection, at_hand, name, obj, high, sculpted)
            images = _bake_images(bench, obj, high, far, size, margin, settings, blocks)
        _wire(obj, images)
    except BaseException:
        made.remove(obj)
        for block in blocks:
            (bpy.data.images if isinstance(block, bpy.types.Image) else bpy.data.materials).remove(block)
        raise
    return Baked(obj, name, images, far)


def _source(context, collection, settings):
    """The object to bake from, and whether it is one with Multires: the latest made of the hierarchy, which is made where there is none."""
    if settings.source == "MULTIRES":
        found = [obj for obj in context.scene.objects if origin_of(obj) == collection and any(one.type == "MULTIRES" for one in obj.modifiers)]
        active = objects.active(context)
        if active in found:
            return active, True
        return (max(found, key=lambda obj: obj.name) if found else conversion.convert(context, collection).obj), True
    source = collection.hybrid_mesh.source
    if source is None:
        raise ValueError(f"{collection.name}: the scan that it was made of is not known, so that there is nothing to bake from but Multires")
    if source.type != "MESH":
        raise ValueError(f"{source.name}, which it was made of, is no mesh any more")
    return source, False


def _level(collection, settings, sculpted):
    name = settings.level
    if not name and sculpted:
        name = conversion.base_level(kept.at_hand(collection).hierarchy)
    level = made.level_object(collection, name) if name else made.shown_level(collection)
    if level is None:
        raise ValueError(f"{collection.name}: there is no object of {name or 'the level that is shown'}")
    if not objects.is_local(level):
        raise ValueError(f"{level.name} comes of a library and cannot be baked on")
    return level


def _islands_a_side(level):
    """How many cells, each with a patch's island, a row of the patches' UV map has."""
    uv, patch = numpy.asarray(level["uv"]), numpy.repeat(level["patch"], numpy.diff(level["offsets"]))
    most, least = numpy.full(patch.max() + 1, -numpy.inf), numpy.full(patch.max() + 1, numpy.inf)
    numpy.maximum.at(most, patch, uv[:, 0])
    numpy.minimum.at(least, patch, uv[:, 0])
    return max(1, round((1 - 2 * _ISLAND_MARGIN) / (most - least)[most > least].max()))


def _image_size(size, side):
    """Pixels of an image's side. Raises ValueError where islands would run into one another."""
    least = math.ceil(side * _LEAST_GAP / _ISLAND_MARGIN)
    if not size:
        wanted = max(least, min(side * _AUTOMATIC_CELL, _AUTOMATIC_SIZES[1]), _AUTOMATIC_SIZES[0])
        size = 2 ** math.ceil(math.log2(wanted))
    if size < least:
        raise ValueError(f"{size:,} pixels are too few for {side} rows of patches, which would run into one another: at least {least:,} keep them apart")
    if size > MOST_SIZE:
        raise ValueError(f"{side} rows of patches take an image of {least:,} pixels, and at most {MOST_SIZE:,} are made: remesh with a smaller base")
    return size


def _use_patches(mesh, level, matrix):
    """Makes the patches' own UV map the active one, as the hierarchy has it: it may have been changed, and its islands are apart."""
    layer = mesh.uv_layers.get(meshes.PATCH_UV)
    if layer is not None:
        mesh.uv_layers.remove(layer)
    meshes.add_uv(mesh, meshes.PATCH_UV, numpy.asarray(level["uv"])[meshes.corner_order(numpy.asarray(level["offsets"]), matrix)])
    layer = mesh.uv_layers.get(meshes.PATCH_UV)
    if layer is None:
        raise ValueError("there are eight UV maps already, and Blender takes no other one: remove one from the level")
    mesh.uv_layers.active = layer
    layer.active_render = True


def _give_material(obj, blocks):
    material = compat.new_material(obj.name)
    blocks.append(material)
    mesh = obj.data
    mesh.materials.clear()
    mesh.materials.append(material)
    meshes.set_materials(mesh, numpy.zeros(len(mesh.polygons), dtype=numpy.int32))


def _surface(context, bench, source, smooth):
    modifiers = [modifier for modifier in source.modifiers if modifier.type == "MULTIRES"]
    shown = [modifier.levels for modifier in modifiers]
    for modifier in modifiers:
        modifier.levels = modifier.total_levels
    try:
        with objects.evaluated(context, source) as graph:
            mesh = bpy.data.meshes.new_from_object(source.evaluated_get(graph), preserve_all_data_layers=True, depsgraph=graph)
    finally:
        for modifier, level in zip(modifiers, shown):
            modifier.levels = level
    if not mesh.polygons:
        bpy.data.meshes.remove(mesh)
        raise ValueError(f"{source.name} has no faces to bake from")
    return bench.surface(mesh, source.matrix_world, smooth)


def _distance(collection, at_hand, name, low, high, sculpted):
    """How far rays start outside a level, in the world: by the Hausdorff distance of the report, or by one that is measured where the report does not have it."""
    found = next((one for one in report_of(collection).get("levels", []) if one.get("level") in (name, int(name[1:]))), {}).get("hausdorff")
    meshes_in_world = [
        (arrays.transformed(points, arrays.world_matrix(obj.matrix_world)), offsets, indices)
        for obj, (points, offsets, indices) in ((obj, meshes.mesh_arrays(obj.data)) for obj in (low, high))
    ]
    diagonal = float(numpy.linalg.norm(numpy.ptp(meshes_in_world[1][0], axis=0)))
    if sculpted or at_hand.edited or found is None:
        # compare() gives it as a fraction of the first one's diagonal.
        found = native().compare(*meshes_in_world[1], *meshes_in_world[0], _SAMPLES)["hausdorff"]
    return min(max(_ROOM * found, 1e-4), _MOST_EXTRUSION) * diagonal


def _bake_images(bench, obj, high, far, size, margin, settings, blocks):
    title = obj.name
    normals = bpy.data.images.new(f"{title} normals", size, size, alpha=False, float_buffer=settings.floats, is_data=True)
    blocks.append(normals)
    bench.bake("NORMAL", obj, normals, high, far, margin)
    normals.pack()
    images = [normals]
    if settings.displacement:
        values, known = baking.heights(bench, obj, high, size, far)
        values = baking.grown(values, known, margin)
        image = bpy.data.images.new(f"{title} displacement", size, size, alpha=False, float_buffer=True, is_data=True)
        blocks.append(image)
        baking.set_pixels(image, numpy.stack([values, values, values, numpy.ones_like(values)], axis=-1))
        image.pack()
        images.append(image)
    return images


def _wire(obj, images):
    """Has the material show its normals. Displacement is at hand but not in use: beside the normals it would count the details twice."""
    nodes, links = obj.data.materials[0].node_tree.nodes, obj.data.materials[0].node_tree.links
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    normal_map, texture = nodes.new("ShaderNodeNormalMap"), _texture(nodes, images[0], (-800, -200))
    normal_map.uv_map, normal_map.space = meshes.PATCH_UV, "TANGENT"
    normal_map.location = (-400, -200)
    links.new(texture.outputs["Color"], normal_map.inputs["Color"])
    links.new(normal_map.outputs["Normal"], shader.inputs["Normal"])
    nodes.active = texture
    if len(images) > 1:
        displacement, texture = nodes.new("ShaderNodeDisplacement"), _texture(nodes, images[1], (-800, -600))
        displacement.space, displacement.location = "WORLD", (-400, -600)
        displacement.inputs["Midlevel"].default_value = 0
        displacement.inputs["Scale"].default_value = 1
        links.new(texture.outputs["Color"], displacement.inputs["Height"])


def _texture(nodes, image, place):
    node = nodes.new("ShaderNodeTexImage")
    node.image, node.location = image, place
    return node
