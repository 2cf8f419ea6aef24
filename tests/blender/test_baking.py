# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals and displacement baked on a level, decoded and compared with the surface that they were baked from."""

import os
import pathlib

import bpy
import numpy
import pytest
from conftest import module
from mathutils.bvhtree import BVHTree
from test_level_editing import activate, by_name, edit, places, refused
from test_make_mesh import painted
from test_multires import counts, shape
from test_samples import SAMPLES

# $HYBRID_MESH_MODELS, or ../shared/models beside the checkout.
MODELS = pathlib.Path(os.environ.get("HYBRID_MESH_MODELS") or pathlib.Path(__file__).resolve().parents[3] / "shared" / "models")
TURNED = {"location": (3, 2, 1), "rotation_euler": (0.3, 0.2, 0.1), "scale": (-2, 2, 2)}


def rough(world, **transform):
    """A ball with details that a coarse level has not, shaded smooth."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=6, radius=1)
    scan = bpy.context.object
    scan.name = "scan"
    points = places(scan).astype(float)
    points *= 1 + 0.01 * numpy.prod(numpy.sin(14 * points), axis=1, keepdims=True) + 0.1 * numpy.sin(2 * points[:, :1])
    scan.data.vertices.foreach_set("co", points.astype(numpy.float32).ravel())
    for polygon in scan.data.polygons:
        polygon.use_smooth = True
    scan.data.update()
    return world.placed(scan, **transform)


def bake(world, obj, **settings):
    """(the object that was made, its images, normals first)."""
    activate(world, obj)
    assert bpy.ops.hybrid_mesh.bake(**settings) == {"FINISHED"}
    made = bpy.context.object
    assert bpy.context.selected_objects == [made] and not made.modifiers and made.visible_get()
    return made, images_of(made)


def images_of(obj):
    nodes = obj.data.materials[0].node_tree.nodes
    return sorted((node.image for node in nodes if node.type == "TEX_IMAGE"), key=lambda image: "displacement" in image.name)


def sample(image, uv):
    """Values of an image at places, bilinearly."""
    width, height = image.size
    pixels = numpy.empty(width * height * 4, dtype=numpy.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, 4)[..., :3].astype(float)
    x, y = uv[:, 0] * width - 0.5, uv[:, 1] * height - 0.5
    left, low = numpy.floor(x).astype(int), numpy.floor(y).astype(int)
    result = 0
    for dx in (0, 1):
        for dy in (0, 1):
            weight = numpy.abs(1 - dx - (x - left)) * numpy.abs(1 - dy - (y - low))
            result = result + weight[:, None] * pixels[numpy.clip(low + dy, 0, height - 1), numpy.clip(left + dx, 0, width - 1)]
    return result


class Surface:
    """An object's mesh in world space, to be sampled at random and asked for the normals at the nearest places."""

    def __init__(self, obj, smooth=True):
        self.obj, self.mesh = obj, bpy.data.meshes.new_from_object(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()))
        matrix = numpy.array(obj.matrix_world, dtype=float)
        self.normal_matrix = numpy.linalg.inv(matrix[:3, :3]).T
        if smooth:
            self.mesh.polygons.foreach_set("use_smooth", numpy.ones(len(self.mesh.polygons), dtype=bool))
        values_of = module("bridge.meshes").values_of
        self.mesh.calc_loop_triangles()
        self.points = module("bridge.arrays").transformed(values_of(self.mesh.vertices, "co", 3).astype(float), matrix)
        self.triangles = values_of(self.mesh.loop_triangles, "vertices", 3, numpy.int32)
        self.loops = values_of(self.mesh.loop_triangles, "loops", 3, numpy.int32)
        self.vertex_normals = values_of(self.mesh.vertices, "normal", 3).astype(float)
        self.size = numpy.linalg.norm(numpy.ptp(self.points, axis=0))

    def in_world(self, normals):
        normals = normals @ self.normal_matrix.T
        return normals / numpy.linalg.norm(normals, axis=1, keepdims=True)

    def random(self, count, seed=1):
        """(triangles, weights) of points that are even over the surface."""
        generator = numpy.random.default_rng(seed)
        corners = self.points[self.triangles]
        areas = numpy.linalg.norm(numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        chosen = generator.choice(len(areas), count, p=areas / areas.sum())
        return chosen, generator.dirichlet((1, 1, 1), count)

    def nearest(self, points):
        """(places, normals) of the nearest points of the surface."""
        tree = BVHTree.FromPolygons(self.points.tolist(), self.triangles.tolist(), all_triangles=True)
        found = [tree.find_nearest(point) for point in points.tolist()]
        places_found, chosen = numpy.array([one[0] for one in found]), numpy.array([one[2] for one in found])
        weights = module("bridge.arrays").closest_weights(places_found, self.points[self.triangles[chosen]])
        return places_found, self.in_world(numpy.einsum("vk,vki->vi", weights, self.vertex_normals[self.triangles[chosen]]))


def decoded(obj, image, count):
    """Random points of a baked object in world space, with the normals that the surface has there by itself, and by the image."""
    surface = Surface(obj)
    mesh, values_of = surface.mesh, module("bridge.meshes").values_of
    mesh.calc_tangents(uvmap="patches")
    normals, tangents = (values_of(mesh.loops, name, 3).astype(float) for name in ("normal", "tangent"))
    signs = values_of(mesh.loops, "bitangent_sign", 1).astype(float)
    chosen, weights = surface.random(count)
    loops = surface.loops[chosen]

    def at(values):
        return numpy.einsum("vk,vk...->v...", weights, values[loops])

    uv = at(values_of(*module("compat").uv_values(mesh.uv_layers["patches"]), 2).astype(float))
    normal, tangent = at(normals), at(tangents)
    bitangent = at(signs)[:, None] * numpy.cross(normal, tangent)
    colour = 2 * sample(image, uv) - 1
    shown = colour[:, :1] * tangent + colour[:, 1:2] * bitangent + colour[:, 2:] * normal
    points = numpy.einsum("vk,vki->vi", weights, surface.points[surface.triangles[chosen]])
    return points, surface.in_world(normal), surface.in_world(shown), uv


def angles(one, other):
    return numpy.degrees(numpy.arccos(numpy.clip((one * other).sum(axis=1), -1, 1)))


def mean_angles(obj, image, high, count=20000):
    """Mean angles in degrees between the normals of a surface and those of a baked object: by the image, and without it."""
    points, own, shown, _ = decoded(obj, image, count)
    _, wanted = Surface(high).nearest(points)
    return angles(shown, wanted).mean(), angles(own, wanted).mean()


@pytest.mark.parametrize("transform", [{}, TURNED, {**TURNED, "scale": (1, -2, 0.5)}])
def test_normals_of_the_scan(world, transform):
    scan = rough(world, **transform)
    _, levels, _ = world.remesh(scan)
    level = by_name(levels)["N1"]
    obj, [image] = bake(world, levels[-1], level="N1")
    assert obj.name == "scan_bake" and len(obj.data.vertices) == len(level.data.vertices)
    with_image, without = mean_angles(obj, image, scan)
    print(f"{with_image:.2f} degrees with the normal map of {image.size[0]} pixels, {without:.2f} without")
    assert with_image < 1.5 and with_image < without / 3
    assert image.colorspace_settings.name == "Non-Color" and image.packed_file is not None


def imported(path):
    points, offsets, indices = module("_native").read_mesh(str(path))
    mesh = bpy.data.meshes.new(path.stem)
    mesh.from_pydata(points.tolist(), [], [indices[begin:end].tolist() for begin, end in zip(offsets[:-1], offsets[1:])])
    obj = bpy.data.objects.new(path.stem, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


@pytest.mark.skipif(not (MODELS / "max_planck.ply").exists(), reason="HYBRID_MESH_MODELS names no folder with max_planck.ply")
def test_normals_of_a_large_scan(world):
    scan = imported(MODELS / "max_planck.ply")
    _, levels, _ = world.remesh(scan, vertices=20000)
    obj, [image] = bake(world, levels[-1], level="N2")
    with_image, without = mean_angles(obj, image, scan)
    print(f"max_planck on N2: {with_image:.2f} degrees with the normal map of {image.size[0]} pixels, {without:.2f} without")
    assert with_image < 3 and with_image < without / 3


def test_a_sample_that_is_shaded_flat(world):
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLES / "bunny.blend"))
    scan = max((obj for obj in bpy.data.objects if obj.type == "MESH"), key=lambda obj: len(obj.data.polygons))
    for polygon in scan.data.polygons:
        polygon.use_smooth = False
    _, levels, _ = world.remesh(scan, vertices=10000)
    obj, [image] = bake(world, levels[-1], level="N2")
    with_image, without = mean_angles(obj, image, scan)
    print(f"bunny on N2: {with_image:.2f} degrees with the normal map of {image.size[0]} pixels, {without:.2f} without")
    assert with_image < 3 and with_image < without / 3


def test_islands_and_margins(world):
    scan = rough(world)
    collection, levels, _ = world.remesh(scan)
    obj, [image] = bake(world, levels[-1], level="N1", size=1024)
    # Every pixel of an island that a point of the surface takes in is baked: none is black, which no normal is.
    _, _, _, uv = decoded(obj, image, 20000)
    assert numpy.linalg.norm(2 * sample(image, uv) - 1, axis=1).min() > 0.9
    # Islands do not overlap: as many places of the map as faces, and none is taken twice.
    mesh, values_of = obj.data, module("bridge.meshes").values_of
    corners = values_of(*module("compat").uv_values(mesh.uv_layers["patches"]), 2).reshape(-1, 4, 2)
    patch = numpy.array([value.value for value in mesh.attributes["patch"].data])
    boxes = [(corners[patch == number].min(axis=(0, 1)), corners[patch == number].max(axis=(0, 1))) for number in numpy.unique(patch)]
    for number, (least, most) in enumerate(boxes):
        for other_least, other_most in boxes[:number]:
            assert (numpy.maximum(least, other_least) - numpy.minimum(most, other_most)).max() * 1024 >= 1.9
    assert mesh.uv_layers.active.name == "patches" and mesh.uv_layers["patches"].active_render
    refused(bpy.ops.hybrid_mesh.bake, "pixels are too few for", size=64)


def test_displacement(world):
    scan = rough(world, **TURNED)
    _, levels, _ = world.remesh(scan)
    obj, [image, height] = bake(world, levels[-1], level="N1", displacement=True)
    assert height.is_float and height.packed_file is not None
    points, normals, _, uv = decoded(obj, image, 5000)
    surface = Surface(scan)
    before = numpy.linalg.norm(surface.nearest(points)[0] - points, axis=1).mean()
    moved = points + normals * sample(height, uv)[:, :1]
    after = numpy.linalg.norm(surface.nearest(moved)[0] - moved, axis=1).mean()
    print(f"mean distance {before / surface.size:.1e} of the size, with displacement {after / surface.size:.1e}")
    assert after < before / 10


def test_of_multires(world):
    _, levels, preview = world.remesh(world.scan())
    world.select(preview)
    assert bpy.ops.hybrid_mesh.convert_to_multires() == {"FINISHED"}
    multires = bpy.context.object
    # A sculpted copy, wrinkled.
    points = shape(multires)
    target = bpy.data.objects.new("target", bpy.data.meshes.new_from_object(multires.evaluated_get(bpy.context.evaluated_depsgraph_get())))
    bpy.context.scene.collection.objects.link(target)
    target.data.vertices.foreach_set("co", (points * (1 + 0.02 * numpy.sin(12 * points[:, 2:]))).astype(numpy.float32).ravel())
    world.select(target, multires)
    assert bpy.ops.object.multires_reshape(modifier="Multires") == {"FINISHED"}
    bpy.data.objects.remove(target)
    shown = multires.modifiers[0].levels = 1
    obj, [image] = bake(world, preview, source="MULTIRES")
    assert len(obj.data.vertices) == len(multires.data.vertices) and multires.modifiers[0].levels == shown
    multires.modifiers[0].levels = multires.modifiers[0].total_levels
    with_image, without = mean_angles(obj, image, multires)
    print(f"of Multires: {with_image:.2f} degrees with the normal map, {without:.2f} without")
    assert with_image < 3 and with_image < without / 4


def test_one_button_is_enough(world):
    _, levels, preview = world.remesh(world.scan())
    obj, _ = bake(world, preview, source="MULTIRES")
    assert "scan_multires" in bpy.data.objects and len(obj.data.vertices) == len(levels[0].data.vertices)


def test_hidden_sources_and_other_objects(world):
    """What is hidden is baked from, and what is in the way is not."""
    scan = rough(world)
    scan.modifiers.new("moved", "DISPLACE").strength = 0
    _, levels, _ = world.remesh(scan)
    world.box("around", scale=(0.9, 0.9, 0.9))
    scan.hide_set(True)
    scan.hide_render = scan.hide_viewport = True
    before = bpy.context.scene.render.engine
    others = counts()
    obj, [image] = bake(world, levels[-1], level="N1")
    assert bpy.context.scene.render.engine == before
    assert set(counts()["objects"]) - set(others["objects"]) == {obj.name} and len(bpy.data.scenes) == 1
    assert set(counts()["materials"]) - set(others["materials"]) == {obj.name} and set(bpy.data.images.keys()) >= {image.name}
    assert scan.hide_render and scan.hide_viewport
    scan.hide_viewport = False
    scan.hide_set(False)
    assert mean_angles(obj, image, scan)[0] < 1.5


def test_the_source_and_its_materials_stay_as_they_are(world):
    scan = painted(world)
    _, levels, _ = world.remesh(scan)

    def materials():
        return [(material.name, len(material.node_tree.nodes) if material.node_tree else 0) for material in scan.data.materials]

    before = materials()
    obj, _ = bake(world, levels[-1], level="N1")
    assert materials() == before
    assert [material.name for material in levels[-1].data.materials] == ["red", "green"]
    assert [material.name for material in obj.data.materials] == [obj.name] and {polygon.material_index for polygon in obj.data.polygons} == {0}
    assert "map" in obj.data.uv_layers and [group.name for group in obj.vertex_groups] == ["top"]


def test_a_reopened_file_has_the_images(world, tmp_path):
    _, levels, _ = world.remesh(rough(world))
    obj, images = bake(world, levels[-1], level="N1", displacement=True)
    pixels = [numpy.array(image.pixels[:]) for image in images]
    name = obj.name
    path = str(tmp_path / "baked.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    for image, before in zip(images_of(bpy.data.objects[name]), pixels):
        assert image.colorspace_settings.name == "Non-Color"
        assert numpy.array_equal(numpy.array(image.pixels[:]), before)


def test_edited_levels(world):
    """The report's distances are those of what was measured: after an edit they are measured anew."""
    scan = rough(world)
    _, levels, _ = world.remesh(scan)
    activate(world, levels[0])
    edit(levels[0], lambda points: points * 1.03)
    obj, [image] = bake(world, levels[0], level="N1")
    assert mean_angles(obj, image, scan)[0] < 2.5


def test_undo(world):
    _, levels, preview = world.remesh(rough(world))
    world.select(preview)
    bpy.ops.ed.undo_push(message="before")
    before, images = counts(), list(bpy.data.images.keys())
    assert bpy.ops.hybrid_mesh.bake("EXEC_DEFAULT", True, level="N1") == {"FINISHED"}
    after = counts()
    bpy.ops.ed.undo()
    assert counts() == before and list(bpy.data.images.keys()) == images
    bpy.ops.ed.redo()
    assert counts() == after and images_of(bpy.data.objects["scan_bake"])[0].packed_file is not None


def test_what_cannot_be_done_is_said(world):
    collection, levels, preview = world.remesh(rough(world))
    world.select(preview)
    before = counts(), list(bpy.data.images.keys())
    refused(bpy.ops.hybrid_mesh.bake, "no object of N17", level="N17")
    collection.hybrid_mesh.source = None
    refused(bpy.ops.hybrid_mesh.bake, "the scan that it was made of is not known", level="N1")
    assert (counts(), list(bpy.data.images.keys())) == before
