# SPDX-License-Identifier: GPL-3.0-or-later
"""Registration is all or nothing, and whatever goes wrong in an operator is said."""

import bpy
import pytest
from conftest import module

registration = module("registration")


def registered():
    """What of the add-on Blender has: classes, properties, handlers."""
    classes = [cls.__name__ for cls in registration.CLASSES if "bl_rna" in cls.__dict__]
    properties = [name for owner, name, _ in registration.PROPERTIES if hasattr(owner, name)]
    return classes, properties, module("jobs")._before_load in bpy.app.handlers.load_pre


@pytest.fixture
def unregistered(monkeypatch):
    """The add-on is as it was before it was enabled; whatever a test has changed is put right again, and it is enabled."""
    assert all(registered())
    registration.unregister()
    yield monkeypatch
    monkeypatch.undo()
    registration.register()
    assert all(registered())


class Broken(bpy.types.Panel):
    bl_label = "Broken"
    bl_space_type = "NOWHERE"
    bl_region_type = "UI"

    def draw(self, context):
        pass


def break_a_class(monkeypatch):
    classes = registration.CLASSES
    monkeypatch.setattr(registration, "CLASSES", (*classes[:9], Broken, *classes[9:]))


def break_a_property(monkeypatch):
    properties = registration.PROPERTIES
    monkeypatch.setattr(registration, "PROPERTIES", (*properties[:2], (bpy.types.Scene, "hybrid_mesh_broken", int), *properties[2:]))


def break_the_command_line(monkeypatch):
    def refuse(name, function):
        raise RuntimeError("no command")

    monkeypatch.setattr(module("compat"), "register_command_line", refuse)


@pytest.mark.parametrize("break_something", [break_a_class, break_a_property, break_the_command_line])
def test_a_failure_half_way_is_loud_and_leaves_nothing(unregistered, break_something):
    assert registered() == ([], [], False)
    with unregistered.context() as patch:
        break_something(patch)
        with pytest.raises((RuntimeError, TypeError, ValueError)):
            registration.register()
        assert registered() == ([], [], False)
    registration.register()
    assert all(registered())
    registration.unregister()


def test_a_machine_that_the_module_does_not_run_on_gets_a_sentence(monkeypatch, capfd):
    package, native = module(""), module("core.native")

    def refuse():
        raise native.NativeMissing("this build of Hybrid Mesh is for another machine")

    package.unregister()
    assert registered() == ([], [], False)
    try:
        with monkeypatch.context() as patch:
            patch.setattr(native, "native", refuse)
            package.register()
            assert registered() == ([], [], False)
            assert capfd.readouterr().err == "Hybrid Mesh: this build of Hybrid Mesh is for another machine.\n"
            panel = module("unsupported").HYBRID_MESH_PT_unsupported
            assert panel.is_registered and panel.reason == "this build of Hybrid Mesh is for another machine."
        package.unregister()
        assert not panel.is_registered
    finally:
        package.register()
    assert all(registered())


def test_registering_twice_is_refused_and_changes_nothing():
    before = registered()
    with pytest.raises(ValueError):
        registration.register()
    assert registered() == before and all(before)


def test_the_command_is_there_while_the_add_on_is(unregistered):
    compat, handles = module("compat"), []
    take, give_back = compat.register_command_line, compat.unregister_command_line
    unregistered.setattr(compat, "register_command_line", lambda *arguments: handles.append(take(*arguments)) or handles[-1])
    unregistered.setattr(compat, "unregister_command_line", lambda handle: (give_back(handle), handles.remove(handle)))
    registration.register()
    assert len(handles) == 1 and (handles[0] is not None) == compat.HAS_COMMAND_LINE
    registration.unregister()
    assert handles == []


def counts():
    return [len(data) for data in (bpy.data.objects, bpy.data.meshes, bpy.data.collections, bpy.data.node_groups, bpy.data.texts)]


def test_what_nobody_foresaw_is_reported_and_nothing_is_left(world, monkeypatch):
    job = module("features.remesh.job")
    build, built = job.build_hierarchy, []

    def fail_the_second_time(*arguments):
        if built:
            raise KeyError("unheard of")
        built.append(build(*arguments))
        return built[-1]

    monkeypatch.setattr(job, "build_hierarchy", fail_the_second_time)
    first, second = world.scan("a", 2), world.scan("b", 2)
    world.select(first, second)
    before = counts()
    with pytest.raises(RuntimeError, match="internal error: KeyError: 'unheard of'"):
        bpy.ops.hybrid_mesh.remesh(vertices=400)
    assert len(built) == 1 and counts() == before


def test_what_fails_before_the_work_is_reported(world, monkeypatch):
    def fail(*arguments):
        raise KeyError("unheard of")

    monkeypatch.setattr(module("features.remesh.operators"), "remesh_task", fail)
    world.scan()
    with pytest.raises(RuntimeError, match="internal error: KeyError: 'unheard of'"):
        bpy.ops.hybrid_mesh.remesh(vertices=400)


def test_what_cannot_be_described_is_not_left_behind(world, monkeypatch):
    def fail(*arguments):
        raise KeyError("unheard of")

    monkeypatch.setattr(module("bridge.levels"), "show_preview_only", fail)
    world.scan("a", 2)
    before = counts()
    with pytest.raises(RuntimeError, match="unheard of"):
        bpy.ops.hybrid_mesh.remesh(vertices=400)
    assert counts() == before


def test_an_operator_that_finds_nothing_to_do_says_so(world, monkeypatch):
    monkeypatch.setattr(module("features.remesh.operators").HYBRID_MESH_OT_remesh, "prepare", lambda self, context: [])
    world.scan()
    with pytest.raises(RuntimeError, match="nothing to do"):
        bpy.ops.hybrid_mesh.remesh(vertices=400)
