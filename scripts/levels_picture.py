# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: a picture of a source mesh and the levels of its hierarchy side by side, and a .blend of the scene.

blender --background --factory-startup --python levels_picture.py -- STAGE HIERARCHY.blend SOURCE.blend PICTURE.png [SCENE.blend]

HIERARCHY.blend is what `remesh --blend` writes; SOURCE.blend holds the object that it was made of. Cycles on the CPU: works without a display."""

import os
import sys

import bpy
import mathutils
import numpy

TILE = 480  # pixels
SAMPLES = 32
GAP = 1.12  # of the largest extent, between two middles
TURN = 0.3  # about the vertical, radians
LINE = 0.0042  # width of the lines, of the object's height
PASTELS = numpy.array([
    [0.80, 0.60, 0.52], [0.86, 0.74, 0.54], [0.66, 0.76, 0.58], [0.54, 0.74, 0.72], [0.56, 0.66, 0.82], [0.72, 0.62, 0.80], [0.84, 0.62, 0.70],
])  # fmt: skip
GREY = numpy.array([0.72, 0.72, 0.70])
CLAY = numpy.array([0.56, 0.47, 0.40])


def corner_distances(points, corners, offsets, height, drawn=None, even=False):
    """For each corner its distance to the lines of up to four edges of its face, in line widths of that face.

    drawn: whether there is a line at the edge from each corner to the next; even: lines as wide on small faces as on large ones.
    """
    distances = numpy.full((len(corners), 4), 1e3, dtype=numpy.float32)
    counts = numpy.diff(offsets)
    for count in (3, 4):
        faces = numpy.nonzero(counts == count)[0]
        if not len(faces):
            continue
        places = offsets[faces][:, None] + numpy.arange(count)
        p = points[corners[places]]
        edges = numpy.roll(p, -1, axis=1) - p
        lengths = numpy.linalg.norm(edges, axis=2)
        width = numpy.full(len(faces), LINE * height) if even else numpy.minimum(LINE * height, 0.07 * lengths.mean(1))
        for k in range(count):
            along = edges[:, k] / numpy.maximum(lengths[:, k], 1e-12)[:, None]
            away = p - p[:, k : k + 1]
            away = away - (away * along[:, None]).sum(2, keepdims=True) * along[:, None]
            distances[places, k] = numpy.linalg.norm(away, axis=2) / width[:, None]
            if drawn is not None:
                distances[places[~drawn[places[:, k]]], k] = 1e3
    return distances


def pastels(numbers):
    """A colour for each number."""
    return PASTELS[(numpy.asarray(numbers, dtype=numpy.int64) * 2654435761 % 4294967296) // 7 % len(PASTELS)]


def display_mesh(name, mesh, height, lines=True, colors=None, drawn=None):
    """A copy of a mesh with what the material needs: distances to edges and a colour a patch, or neither.

    colors: (faces, 3) to be used instead; drawn: see corner_distances, with lines of one width.
    """
    copy = bpy.data.meshes.new(name)
    points = numpy.empty(3 * len(mesh.vertices), dtype=numpy.float32)
    mesh.vertices.foreach_get("co", points)
    corners = numpy.empty(len(mesh.loops), dtype=numpy.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    totals = numpy.empty(len(mesh.polygons), dtype=numpy.int32)
    mesh.polygons.foreach_get("loop_total", totals)
    offsets = numpy.concatenate([[0], numpy.cumsum(totals)])
    if colors is None and lines and "patch" in mesh.attributes:
        patch = numpy.zeros(len(mesh.polygons), dtype=numpy.int32)
        mesh.attributes["patch"].data.foreach_get("value", patch)
        colors = pastels(patch)
    elif colors is None:
        colors = numpy.repeat((GREY if lines else CLAY)[None], len(mesh.polygons), axis=0)
    copy.from_pydata(points.reshape(-1, 3).tolist(), [], [corners[a:b].tolist() for a, b in zip(offsets[:-1], offsets[1:])])
    copy.polygons.foreach_set("use_smooth", [True] * len(copy.polygons))
    edges = corner_distances(points.reshape(-1, 3).astype(float), corners, offsets, height, drawn, drawn is not None)
    for label, values in (
        ("edges", edges if lines else numpy.full_like(edges, 1e3)),
        ("tint", numpy.repeat(numpy.concatenate([colors, numpy.ones((len(colors), 1))], axis=1), totals, axis=0)),
    ):
        attribute = copy.attributes.new(label, "FLOAT_COLOR", "CORNER")
        attribute.data.foreach_set("color", values.astype(numpy.float32).ravel())
    return copy


def material():
    made = bpy.data.materials.new("Quads")
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    surface = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    surface.inputs["Roughness"].default_value = 0.65

    def attribute(name):
        node = nodes.new("ShaderNodeAttribute")
        node.attribute_name = name
        return node

    def math(operation, a, b):
        node = nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, value in zip(node.inputs, (a, b)):
            if isinstance(value, float):
                socket.default_value = value
            else:
                links.new(value, socket)
        return node.outputs[0]

    edges = attribute("edges")
    separate = nodes.new("ShaderNodeSeparateXYZ")
    links.new(edges.outputs["Vector"], separate.inputs[0])
    nearest = math("MINIMUM", math("MINIMUM", separate.outputs[0], separate.outputs[1]), math("MINIMUM", separate.outputs[2], edges.outputs["Alpha"]))
    inside = math("GREATER_THAN", nearest, 0.5)
    mix = nodes.new("ShaderNodeMixRGB")
    mix.inputs[1].default_value = (0.035, 0.04, 0.055, 1)
    links.new(inside, mix.inputs[0])
    links.new(attribute("tint").outputs["Color"], mix.inputs[2])
    links.new(mix.outputs[0], surface.inputs["Base Color"])
    return made


def plain_material(name, color):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    made.node_tree.nodes.clear()
    emission = made.node_tree.nodes.new("ShaderNodeEmission")
    emission.inputs[0].default_value = color
    output = made.node_tree.nodes.new("ShaderNodeOutputMaterial")
    made.node_tree.links.new(emission.outputs[0], output.inputs[0])
    return made


def label(text, place, size, ink):
    name = text.replace("\n", ", ")
    curve = bpy.data.curves.new(name, "FONT")
    curve.body, curve.size, curve.align_x = text, size, "CENTER"
    curve.materials.append(ink)
    obj = bpy.data.objects.new(name, curve)
    obj.location, obj.rotation_euler = place, (numpy.pi / 2, 0, 0)
    return obj


def build(parts):
    """parts: (label, mesh, whether its edges and patches are shown). Returns (collection, columns, rows, tile size)."""
    collection = bpy.data.collections.new("Side by side")
    bpy.context.scene.collection.children.link(collection)
    points = numpy.empty(3 * len(parts[0][1].vertices), dtype=numpy.float32)
    parts[0][1].vertices.foreach_get("co", points)
    points = points.reshape(-1, 3)
    points = points @ numpy.array([[numpy.cos(TURN), numpy.sin(TURN), 0], [-numpy.sin(TURN), numpy.cos(TURN), 0], [0, 0, 1]])
    low, high = points.min(0), points.max(0)
    middle, extent = (low + high) / 2, (high - low)[[0, 2]].max()
    count = len(parts)
    columns = count if count <= 4 else (count + 1) // 2
    rows = -(-count // columns)
    quads, ink = material(), plain_material("Ink", (0.03, 0.035, 0.05, 1))
    step = GAP * extent
    for number, (text, mesh, lines) in enumerate(parts):
        column, row = number % columns, number // columns
        x, z = (column - (columns - 1) / 2) * step, ((rows - 1) / 2 - row) * 1.14 * step
        copy = display_mesh(text, mesh, extent, lines)
        copy.materials.append(quads)
        obj = bpy.data.objects.new(text, copy)
        obj.rotation_euler = (0, 0, TURN)
        obj.location = (x - middle[0], -middle[1], z - middle[2])
        collection.objects.link(obj)
        collection.objects.link(label(text, (x, -2 * extent, z - 0.62 * extent), 0.085 * extent, ink))
    return collection, columns, rows, step


def light_and_camera(collection, columns, rows, step, wide=1.0, high=1.0):
    """wide, high: of a tile, where it is narrower or lower than its step."""
    scene = bpy.context.scene
    world = scene.world or bpy.data.worlds.new("World")
    scene.world = world
    world.use_nodes = True
    # Paper white behind, softer light around.
    nodes, links = world.node_tree.nodes, world.node_tree.links
    background = nodes["Background"]
    background.inputs[0].default_value = (0.90, 0.91, 0.93, 1)
    seen, mix = nodes.new("ShaderNodeLightPath"), nodes.new("ShaderNodeMapRange")
    mix.inputs["To Min"].default_value, mix.inputs["To Max"].default_value = 0.42, 1.05
    links.new(seen.outputs["Is Camera Ray"], mix.inputs["Value"])
    links.new(mix.outputs[0], background.inputs[1])
    for name, strength, rotation in (("Key", 2.3, (0.9, 0.15, 0.5)), ("Fill", 0.5, (1.1, 0, -0.9))):
        sun = bpy.data.lights.new(name, "SUN")
        sun.energy, sun.angle = strength, 0.03
        obj = bpy.data.objects.new(name, sun)
        obj.rotation_euler = rotation
        collection.objects.link(obj)
    camera = bpy.data.cameras.new("Camera")
    camera.type = "ORTHO"
    camera.ortho_scale = max(columns * wide * step, rows * (high + 0.14) * step)
    camera.clip_end = 100 * step
    obj = bpy.data.objects.new("Camera", camera)
    obj.location, obj.rotation_euler = (0, -5 * step, -0.03 * step), (numpy.pi / 2, 0, 0)
    collection.objects.link(obj)
    scene.camera = obj
    render = scene.render
    render.resolution_x, render.resolution_y = int(columns * wide * TILE), int(rows * TILE * (high + 0.14))
    render.resolution_percentage = 100
    render.image_settings.file_format = "PNG"
    render.image_settings.color_mode = "RGB"
    render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = SAMPLES
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = 2
    scene.view_settings.view_transform = "Standard"


def main():
    stage, hierarchy_path, source_path, picture, *scene_path = sys.argv[sys.argv.index("--") + 1 :]
    sys.path.insert(0, stage)
    import hybrid_mesh

    hybrid_mesh.register()
    from hybrid_mesh.bridge import levels as level_bridge

    bpy.ops.wm.open_mainfile(filepath=os.path.abspath(hierarchy_path))
    collection = next(collection for collection in bpy.data.collections if collection.hybrid_mesh.preview)
    preview = collection.hybrid_mesh.preview
    with bpy.data.libraries.load(os.path.abspath(source_path)) as (found, wanted):
        wanted.objects = [name for name in found.objects if name == preview.name.removesuffix(".preview")]
    source = wanted.objects[0]
    bpy.context.scene.collection.objects.link(source)
    collection.hybrid_mesh.source = source
    levels = [obj for obj in collection.objects if obj.hybrid_mesh.role == "LEVEL"]
    levels.sort(key=lambda obj: len(obj.data.polygons))
    parts = [(f"scan: {len(source.data.vertices):,} vertices", source.data, True)]
    parts += [(f"{obj.hybrid_mesh.level}: {len(obj.data.polygons):,} quads", obj.data, True) for obj in levels]
    if len(parts) > 4 and len(parts) % 2:
        parts.append((f"{levels[-1].hybrid_mesh.level}, shaded", levels[-1].data, False))
    side_by_side, columns, rows, step = build(parts)
    light_and_camera(side_by_side, columns, rows, step)
    preview.hide_render = source.hide_render = True
    bpy.context.scene.render.filepath = os.path.abspath(picture)
    bpy.ops.render.render(write_still=True)
    if scene_path:
        # What one opens: the scan, and beside it the preview with its Level input; the picture's copies are there, hidden.
        side_by_side.hide_viewport = True
        preview.hide_render = source.hide_render = False
        preview.location.x += 1.2 * max(source.dimensions)
        bpy.context.view_layer.objects.active = preview
        for obj in bpy.context.view_layer.objects:
            obj.select_set(False)
        level_bridge.set_level(preview, len(levels) - 1)
        for screen in bpy.data.screens:
            for area in screen.areas:
                if area.type == "VIEW_3D":
                    space = area.spaces.active
                    space.shading.color_type = "VERTEX"
                    space.overlay.show_wireframes = True
                    space.show_region_ui = True
                    space.region_3d.view_location = (0.6 * max(source.dimensions), 0, 0.5 * max(source.dimensions))
                    space.region_3d.view_distance = 3.2 * max(source.dimensions)
                    space.region_3d.view_rotation = mathutils.Euler((1.35, 0, 0.3)).to_quaternion()
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(scene_path[0]), compress=True)


if __name__ == "__main__":
    main()
