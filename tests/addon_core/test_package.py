# SPDX-License-Identifier: GPL-3.0-or-later
"""Rules about the package itself."""

import ast
import pathlib
import re

import hybrid_mesh
import pytest
from hybrid_mesh.core.version import VERSION

ROOT = pathlib.Path(__file__).resolve().parents[2]
ADDON = ROOT / "addon"
MODULES = sorted(ADDON.rglob("*.py"))


def imports(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.module


@pytest.mark.parametrize("path", [path for path in MODULES if "core" in path.relative_to(ADDON).parts], ids=lambda path: path.name)
def test_the_core_imports_no_bpy(path):
    assert not any(name.split(".")[0] in {"bpy", "mathutils", "bmesh", "gpu"} for name in imports(path))


@pytest.mark.parametrize("path", [path for path in MODULES if "bridge" not in path.relative_to(ADDON).parts], ids=lambda path: path.name)
def test_arrays_cross_over_in_the_bridge_alone(path):
    assert "foreach_get(" not in path.read_text(encoding="utf-8") and "foreach_set(" not in path.read_text(encoding="utf-8")


@pytest.mark.parametrize("path", [path for path in MODULES if path.name != "compat.py"], ids=lambda path: path.name)
def test_one_module_asks_for_the_version(path):
    if path.parent.name != "tests":
        assert "app.version" not in path.read_text(encoding="utf-8")


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.name)
def test_every_file_names_its_licence(path):
    assert path.read_text(encoding="utf-8").startswith("# SPDX-License-Identifier: GPL-3.0-or-later\n")


def test_every_operator_and_panel_is_registered():
    listed = (ADDON / "registration.py").read_text(encoding="utf-8")
    for path in ADDON.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef) and re.match(r"HYBRID_MESH_|HybridMesh", node.name):
                assert f".{node.name}," in listed, f"{node.name} is not registered"


def test_all_versions_are_one():
    manifest = (ADDON / "blender_manifest.toml").read_text()
    assert f'version = "{VERSION}"' in manifest
    assert ".".join(map(str, hybrid_mesh.bl_info["version"])) == VERSION
    assert f"VERSION {VERSION} " in (ROOT / "CMakeLists.txt").read_text()
