# SPDX-License-Identifier: GPL-3.0-or-later
"""A character made for tests: a body of one piece on an armature, with shape keys, moving."""

import bpy
import mathutils
import numpy

# Bones by name: parent, head, tail, how thick the body is around it.
BONES = {
    "spine": (None, (0, 0, 0), (0, 0, 1.0), 0.34), "head": ("spine", (0, 0, 1.0), (0, 0, 1.7), 0.3),
    "arm.L": ("spine", (0.3, 0, 0.9), (0.9, 0, 0.8), 0.17), "hand.L": ("arm.L", (0.9, 0, 0.8), (1.5, 0, 0.7), 0.15),
    "arm.R": ("spine", (-0.3, 0, 0.9), (-0.9, 0, 0.8), 0.17), "hand.R": ("arm.R", (-0.9, 0, 0.8), (-1.5, 0, 0.7), 0.15),
    "leg.L": ("spine", (0.2, 0, 0), (0.3, 0, -0.7), 0.2), "foot.L": ("leg.L", (0.3, 0, -0.7), (0.35, 0, -1.4), 0.17),
    "leg.R": ("spine", (-0.2, 0, 0), (-0.3, 0, -0.7), 0.2), "foot.R": ("leg.R", (-0.3, 0, -0.7), (-0.35, 0, -1.4), 0.17),
}  # fmt: skip
FRAMES = range(1, 11)


def body(name="character", resolution=0.045):
    """The body alone, as a mesh object."""
    ball = bpy.data.metaballs.new("body")
    ball.resolution = resolution
    for _, head, tail, radius in BONES.values():
        for step in numpy.linspace(0, 1, 9):
            element = ball.elements.new()
            element.co, element.radius = mathutils.Vector(head).lerp(mathutils.Vector(tail), step), 1.5 * radius
    obj = bpy.data.objects.new("body", ball)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.update()
    mesh = bpy.data.meshes.new_from_object(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    mesh.name = name
    bpy.data.objects.remove(obj)
    bpy.data.metaballs.remove(ball)
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


def distances(points, head, tail):
    """Of points from a line from head to tail."""
    head, along = numpy.array(head, dtype=float), numpy.array(tail, dtype=float) - head
    share = numpy.clip((points - head) @ along / (along @ along), 0, 1)
    return numpy.linalg.norm(points - head - share[:, None] * along, axis=1)


def points_of(obj):
    points = numpy.empty(3 * len(obj.data.vertices), dtype=numpy.float32)
    obj.data.vertices.foreach_get("co", points)
    return points.reshape(-1, 3).astype(float)


def add_armature(obj):
    """An armature for the body, with smooth weights, and an Armature modifier."""
    rig = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, (parent, head, tail, _) in BONES.items():
        bone = rig.data.edit_bones.new(name)
        bone.head, bone.tail = head, tail
        bone.parent = rig.data.edit_bones[parent] if parent else None
    bpy.ops.object.mode_set(mode="OBJECT")
    points = points_of(obj)
    shares = numpy.array([(distances(points, head, tail) / radius + 0.05) ** -4 for _, head, tail, radius in BONES.values()])
    shares /= shares.sum(axis=0)
    for name, weights in zip(BONES, shares):
        group = obj.vertex_groups.new(name=name)
        for vertex in numpy.nonzero(weights > 0.005)[0]:
            group.add([int(vertex)], float(weights[vertex]), "REPLACE")
    modifier = obj.modifiers.new("Armature", "ARMATURE")
    modifier.object = rig
    obj.parent = rig
    return rig


def add_shape_keys(obj):
    """Three keys, one of which goes by another and one by a vertex group."""
    points = points_of(obj)
    obj.shape_key_add(name="Basis")

    def add(name, change):
        key = obj.shape_key_add(name=name, from_mix=False)
        key.data.foreach_set("co", (points + change).astype(numpy.float32).ravel())
        return key

    belly = numpy.exp(-((points - (0, -0.3, 0.4)) ** 2).sum(axis=1) / 0.15)
    big = add("belly", belly[:, None] * (0, -0.3, 0))
    turned = add("turned", (points[:, 2:] > 1) * (points[:, 2:] - 1) * numpy.stack([-points[:, 1], points[:, 0], 0 * points[:, 0]], axis=1))
    over = add("over", belly[:, None] * (0, -0.45, 0.1))
    over.relative_key = big
    turned.vertex_group = "head"
    turned.slider_min, turned.slider_max = -2, 2
    return obj.data.shape_keys


def animate(obj, rig):
    """Ten poses, a frame each; one key has an action, another a driver."""
    generator = numpy.random.default_rng(5)
    for frame in FRAMES:
        for bone in rig.pose.bones:
            bone.rotation_mode = "XYZ"
            bone.rotation_euler = generator.uniform(-0.5, 0.5, 3)
            bone.keyframe_insert("rotation_euler", frame=frame)
        key = obj.data.shape_keys.key_blocks["belly"]
        key.value = frame / 10
        key.keyframe_insert("value", frame=frame)
    driver = obj.data.shape_keys.key_blocks["turned"].driver_add("value").driver
    driver.type, driver.expression = "SCRIPTED", "frame / 10"
    obj.data.shape_keys.key_blocks["over"].value = 0.5


def character(animated=True, resolution=0.045):
    """(body, armature)."""
    obj = body(resolution=resolution)
    rig = add_armature(obj)
    add_shape_keys(obj)
    if animated:
        animate(obj, rig)
    bpy.context.view_layer.update()
    return obj, rig


def at_rest(rig, rest=True):
    rig.data.pose_position = "REST" if rest else "POSE"
    bpy.context.view_layer.update()
