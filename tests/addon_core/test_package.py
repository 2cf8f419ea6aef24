# SPDX-License-Identifier: GPL-3.0-or-later
"""Rules about the package itself."""

import ast
import os
import pathlib
import re
import shutil
import subprocess
import sys

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
    for path in set(ADDON.rglob("*.py")) - {ADDON / "unsupported.py"}:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef) and re.match(r"HYBRID_MESH_|HybridMesh", node.name):
                assert f".{node.name}," in listed, f"{node.name} is not registered"


def test_all_versions_are_one():
    manifest = (ADDON / "blender_manifest.toml").read_text()
    assert f'version = "{VERSION}"' in manifest
    assert ".".join(map(str, hybrid_mesh.bl_info["version"])) == VERSION
    assert f"VERSION {VERSION} " in (ROOT / "CMakeLists.txt").read_text()


MODULE = "_native.cpython-{}-x86_64-linux-gnu.so"
THIS = "{}{}".format(*sys.version_info)


@pytest.mark.parametrize(
    "files, changed, said",
    [
        ([THIS], "platform.machine = lambda: 'aarch64'", "is for Linux on x86-64 processors, not for Linux on aarch64"),
        ([THIS], "sys.platform, platform.system, platform.machine = 'darwin', lambda: 'Darwin', lambda: 'arm64'", "is for Linux on x86-64 processors, not for Darwin on arm64"),
        (["39", "310"], "", "is for Python 3.9 and 3.10, not for Python {}.{}, which runs here".format(*sys.version_info)),
        ([], "", "cannot be loaded"),
        ([THIS], "", "file too short"),
    ],
)  # fmt: skip
def test_where_the_module_does_not_run_there_is_one_sentence(tmp_path, files, changed, said):
    shutil.copytree(ADDON, tmp_path / "hybrid_mesh", ignore=shutil.ignore_patterns("*.so", "__pycache__"))
    for tag in files:
        (tmp_path / "hybrid_mesh" / MODULE.format(tag)).write_bytes(b"")
    code = f"import platform, sys; {changed or 'pass'}; from hybrid_mesh.core import cli; sys.exit(cli.run(['remesh', 'a.obj', '--output', 'out']))"
    run = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(tmp_path)}, capture_output=True, encoding="utf-8")
    assert (run.returncode, run.stdout, run.stderr.count("\n")) == (1, "", 1) and said in run.stderr


def test_a_system_that_is_too_old_is_named(monkeypatch, tmp_path):
    from hybrid_mesh.core import native

    (tmp_path / "core").mkdir()
    (tmp_path / MODULE.format(THIS)).write_bytes(b"")
    monkeypatch.setattr(native, "__file__", str(tmp_path / "core/native.py"))
    text = native._misfit(ImportError("/lib/x86_64-linux-gnu/libc.so.6: version `GLIBC_2.99' not found (required by _native.so)"))
    assert text.startswith("this build of Hybrid Mesh needs glibc 2.99 or later; this system has glibc 2.")
