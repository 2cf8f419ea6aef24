# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender, or under the bpy module: installs the add-on's zip as a user would, enables it, and then, if asked, runs pytest.

blender --background --factory-startup --python-exit-code 1 --python blender_session.py -- ZIP [PYTEST ARGUMENTS]
python blender_session.py -- ZIP [PYTEST ARGUMENTS]

The tests find the name of the installed package in HYBRID_MESH_PACKAGE. scripts/blender-tests sees to a fresh BLENDER_USER_RESOURCES."""

import importlib
import os
import sys

import bpy


def install(path):
    """Returns the name of the installed package."""
    if bpy.app.version >= (4, 2, 0):
        result = bpy.ops.extensions.package_install_files(repo="user_default", filepath=path, enable_on_install=True)
        name = "bl_ext.user_default.hybrid_mesh"
    else:
        result = bpy.ops.preferences.addon_install(filepath=path, overwrite=True)
        name = "hybrid_mesh"
        bpy.ops.preferences.addon_enable(module=name)
    if "FINISHED" not in result:
        sys.exit(f"blender_session: Blender would not install {path}: {result}")
    if name not in bpy.context.preferences.addons:
        sys.exit(f"blender_session: {name} is installed but could not be enabled")
    module = importlib.import_module(name)
    resources = os.path.realpath(os.environ["BLENDER_USER_RESOURCES"])
    if not os.path.realpath(module.__file__).startswith(resources + os.sep):
        sys.exit(f"blender_session: {name} comes from {module.__file__}, not from the zip that was installed")
    return name


def main():
    arguments = sys.argv[sys.argv.index("--") + 1 :]
    name = install(os.path.abspath(arguments[0]))
    os.environ["HYBRID_MESH_PACKAGE"] = name
    print(f"Blender {bpy.app.version_string}: {name} installed and enabled", flush=True)
    if arguments[1:]:
        import pytest

        code = int(pytest.main(arguments[1:]))
        sys.stdout.flush()
        sys.exit(code)
    bpy.ops.wm.save_userpref()


main()
