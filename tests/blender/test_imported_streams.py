# SPDX-License-Identifier: GPL-3.0-or-later
"""Streams in the scene: their levels show as many of the first bytes as one wants."""

import bpy
import numpy
import pytest
from conftest import module
from file_tools import clear, import_hmesh, native_of, scene_contents, written_stream
from test_level_editing import activate, edit, move, places, refused


def prefix_points(world, path, count):
    hierarchy = world.native().load_hierarchy(str(path), most_bytes=count)
    return {name: hierarchy.level_points(name) for name in hierarchy.level_names}


def shows(levels, points):
    return all(numpy.array_equal(places(obj), points[name].astype(numpy.float32)) for name, obj in levels.items())


@pytest.fixture
def stream(world, tmp_path):
    return written_stream(world, tmp_path)


@pytest.fixture
def least(stream):
    return module("core.hierarchy_files").least_prefix(stream[0].read_bytes())


def test_all_of_a_stream(world, stream):
    path, size, final = stream
    collection, levels, preview = import_hmesh(world, path)
    assert preview.name == "small.preview" and shows(levels, prefix_points(world, path, size))
    keys = ("points", "offsets", "indices")
    assert world.native().compare(*(final[key] for key in keys), *world.evaluated(preview), 20000)["l2"] < 1e-5
    assert (collection.hybrid_mesh_stream.bytes, collection.hybrid_mesh_stream.size) == (size, size)


def test_the_first_bytes_of_a_stream(world, stream, least):
    path, size, _ = stream
    for count in (least, size // 4, size, 2 * size):
        collection, levels, _ = import_hmesh(world, path, part="PREFIX", most_bytes=count)
        assert shows(levels, prefix_points(world, path, count)) and collection.hybrid_mesh_stream.bytes == min(count, size)
    before = scene_contents()
    words = f"small.hmesh: {least - 1:,} bytes are too few: the base alone takes {least:,}"
    refused(bpy.ops.hybrid_mesh.import_hmesh, words, filepath=str(path), part="PREFIX", most_bytes=least - 1)
    assert scene_contents() == before


def test_bytes_change_what_the_levels_show(world, stream, least):
    path, size, _ = stream
    collection, levels, preview = import_hmesh(world, path)
    whole, blocks = world.evaluated(preview)[0], scene_contents()
    stream_properties = collection.hybrid_mesh_stream
    for asked, shown in ((size // 3, size // 3), (1, least), (2, least), (10 * size, size)):
        stream_properties.bytes = asked
        assert stream_properties.bytes == shown and shows(levels, prefix_points(world, path, shown))
        # The hierarchy at hand is that of the bytes.
        activate(world, levels["N1"])
        refused(bpy.ops.hybrid_mesh.update_levels, "is as it was")
    assert numpy.array_equal(world.evaluated(preview)[0], whole) and scene_contents() == blocks


def test_bytes_do_not_push_other_hierarchies_out_of_memory(world, stream):
    path, size, _ = stream
    scan = world.scan()
    remeshed, _, _ = world.remesh(scan, vertices=500)
    collection, _, _ = import_hmesh(world, path)
    for count in range(size // 2, size // 2 + 20):
        collection.hybrid_mesh_stream.bytes = count
    assert native_of(remeshed) is not None


def test_what_was_edited_is_not_lost(world, stream):
    path, size, _ = stream
    collection, levels, _ = import_hmesh(world, path)
    streams = module("features.levels.streams")
    finest = levels[list(levels)[-1]]
    activate(world, levels["N1"])
    move(levels["N1"], lambda points: points + (0, 0, 1))
    held = places(levels["N1"])
    collection.hybrid_mesh_stream.bytes = size // 2
    assert collection.hybrid_mesh_stream.bytes == size and numpy.array_equal(places(levels["N1"]), held)
    with pytest.raises(ValueError, match="small.N1 was edited and would lose that"):
        streams.show(collection, size // 2)
    assert streams.is_shown(collection)
    before = places(finest)
    assert bpy.ops.hybrid_mesh.update_levels() == {"FINISHED"}
    assert numpy.abs(places(finest) - before - (0, 0, 1)).max() < 1e-5
    collection.hybrid_mesh_stream.bytes = size // 2
    assert collection.hybrid_mesh_stream.bytes == size and not streams.is_shown(collection)
    with pytest.raises(ValueError, match="its levels were edited"):
        streams.show(collection, size // 2)


def test_undo_goes_back_to_the_bytes_that_were_shown(world, stream):
    path, size, _ = stream
    import_hmesh(world, path)
    bpy.ops.ed.undo_push(message="imported")

    def stream_properties():
        return bpy.data.collections["small hierarchy"].hybrid_mesh_stream

    def levels():
        return {obj.hybrid_mesh.level: obj for obj in bpy.data.collections["small hierarchy"].objects if obj.hybrid_mesh.role == "LEVEL"}

    for count in (size // 2, size // 4):
        stream_properties().bytes = count
        bpy.ops.ed.undo_push(message="bytes")
    for count in (size // 2, size):
        bpy.ops.ed.undo()
        assert stream_properties().bytes == count and shows(levels(), prefix_points(world, path, count))
        activate(world, levels()["N1"])
        refused(bpy.ops.hybrid_mesh.update_levels, "is as it was")
    bpy.ops.ed.redo()
    assert stream_properties().bytes == size // 2
    # From an edit back to the stream, too.
    activate(world, levels()["N1"])
    move(levels()["N1"], lambda points: points + (0, 0, 1))
    assert bpy.ops.hybrid_mesh.update_levels("EXEC_DEFAULT", True) == {"FINISHED"}
    bpy.ops.ed.undo()
    bpy.ops.ed.undo()
    stream_properties().bytes = size // 3
    assert shows(levels(), prefix_points(world, path, size // 3))


@pytest.mark.parametrize("is_edited", [False, True])
def test_a_saved_file_goes_on(world, stream, tmp_path, is_edited):
    path, size, _ = stream
    collection, levels, _ = import_hmesh(world, path, part="PREFIX", most_bytes=size // 2)
    if is_edited:
        activate(world, levels["N1"])
        edit(levels["N1"], lambda points: points + (0, 0, 1))
    held = {obj.name: places(obj) for obj in levels.values()}
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "levels.blend"))
    # The stream says what there is, and needs no copy in another form.
    assert ("hybrid_mesh_hierarchy" in collection) == is_edited
    clear()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "levels.blend"))
    collection = bpy.data.collections["small hierarchy"]
    assert all(numpy.array_equal(places(bpy.data.objects[name]), points) for name, points in held.items())
    activate(world, bpy.data.objects["small.N1"])
    refused(bpy.ops.hybrid_mesh.update_levels, "is as it was")
    collection.hybrid_mesh_stream.bytes = size
    levels = {obj.hybrid_mesh.level: obj for obj in collection.objects if obj.hybrid_mesh.role == "LEVEL"}
    assert shows(levels, prefix_points(world, path, size)) == (not is_edited)
    if is_edited:
        assert all(numpy.array_equal(places(bpy.data.objects[name]), points) for name, points in held.items())


def test_a_damaged_stream_in_a_file_is_none(world, stream):
    path, size, _ = stream
    collection, levels, _ = import_hmesh(world, path)
    for damaged in (b"", b"HMw\x01", b"\xff" * 100, "text", None):
        del collection["hybrid_mesh_stream_bytes"]
        collection["hybrid_mesh_stream_bytes"] = damaged if damaged is not None else 1
        module("features.levels.kept").forget()
        activate(world, levels["N1"])
        refused(bpy.ops.hybrid_mesh.update_levels, "import its file again")
        collection.hybrid_mesh_stream.bytes = size // 2
        assert collection.hybrid_mesh_stream.bytes == size
