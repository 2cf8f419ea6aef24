# SPDX-License-Identifier: GPL-3.0-or-later
"""The repository's own rules: which layer may include what, what `addon/core` may import, and what no file may say."""

import ast
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LAYERS = ["decoder", "base", "surface", "parameterization", "topology", "layout", "hierarchy", "construction", "subdivision", "wavelets", "remesh", "codec", "bindings"]
# Folders inside a layer. A file outside them is seen by all of them, and sees none.
ROOMS = {"decoder": ["bits", "forest", "structure", "transform", "planes", "reader"], "layout": ["curves", "disks", "base", "regions", "drawn", "operations", "search"]}
SOURCE = {".h", ".cpp", ".py", ".cmake", ".go", ".js", ".css", ".html", ".yaml", ".yml"}


def files():
    """Everything under version control or about to be, as paths relative to the root."""
    listed = subprocess.run(
        ["git", "-c", "safe.directory=*", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT, capture_output=True
    )
    if listed.returncode == 0:
        names = [Path(name) for name in listed.stdout.decode().split("\0") if name]
        return sorted({name for name in names if (ROOT / name).is_file()})
    folders = ["native", "addon", "scripts", "tests", "docs", "blend_samples"]  # an exported tree
    return sorted(p.relative_to(ROOT) for folder in folders for p in (ROOT / folder).rglob("*") if p.is_file())


def text_of(path):
    try:
        return (ROOT / path).read_text("utf-8")
    except UnicodeDecodeError:
        return ""


def includes(text):
    return re.findall(r'^\s*#\s*include\s*"([^"]+)"', text, re.MULTILINE)


def upward_includes(layer, text):
    """The includes of a file of `layer` that name a layer to its right, or no layer at all."""
    allowed = LAYERS[: LAYERS.index(layer) + 1]
    return [name for name in includes(text) if name.split("/")[0] not in allowed]


def includes_of_later_rooms(layer, path, text):
    """The includes of a file that name a room of its own layer which comes after the file's."""
    rooms = ROOMS[layer]
    allowed = rooms[: rooms.index(path.parts[2]) + 1] if len(path.parts) > 3 else []
    named = [name.split("/") for name in includes(text)]
    return ["/".join(parts) for parts in named if parts[0] == layer and len(parts) > 2 and parts[1] not in allowed]


def imported_modules(path, text):
    """What a Python file imports, wherever in it, by full names: `..bridge` in addon/core/worker.py is addon.bridge."""
    names = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            module = [*path.parts[: len(path.parts) - node.level], *filter(None, [node.module])] if node.level else [node.module]
            # `from .. import bridge` imports the module; of `from ..bridge import meshes` it is enough to know the package.
            names += [".".join([*module, alias.name]) for alias in node.names] if node.module is None else [".".join(module)]
    return names


def imports_outside(folders, path, text):
    """The imports of a file of the add-on that name a module of the add-on outside some folders, which are dotted names."""
    inside = [name for name in imported_modules(path, text) if name.split(".")[0] == "addon"]
    return [name for name in inside if not any(name == folder or name.startswith(folder + ".") for folder in folders)]


NATIVE = [path for path in files() if path.parts[0] == "native" and path.suffix in {".h", ".cpp"}]
CORE = [path for path in files() if path.parts[:2] == ("addon", "core") and path.suffix == ".py"]


def test_there_is_something_to_check():
    assert NATIVE and CORE


def test_every_native_folder_is_a_layer():
    assert {path.parts[1] for path in NATIVE} <= set(LAYERS)


def test_cmake_builds_the_layers_in_this_order():
    declared = re.findall(r"^hybrid_mesh_layer\((\w+)", text_of("native/CMakeLists.txt"), re.MULTILINE)
    assert declared == LAYERS[:-1]


@pytest.mark.parametrize("layer", LAYERS)
def test_no_layer_includes_upwards(layer):
    wrong = {str(path): upward_includes(layer, text_of(path)) for path in NATIVE if path.parts[1] == layer}
    assert {path: names for path, names in wrong.items() if names} == {}


@pytest.mark.parametrize("layer", ROOMS)
def test_no_room_includes_a_later_one(layer):
    inside = [path for path in NATIVE if path.parts[1] == layer]
    assert {path.parts[2] for path in inside if len(path.parts) > 3} == set(ROOMS[layer])
    wrong = {str(path): includes_of_later_rooms(layer, path, text_of(path)) for path in inside}
    assert {path: names for path, names in wrong.items() if names} == {}


def test_an_include_of_a_later_room_is_seen():
    text = '#include "layout/drawn/drawn_layout.h"\n#include "layout/curves/surface_paths.h"\n'
    assert includes_of_later_rooms("layout", Path("native/layout/curves/a.h"), text) == ["layout/drawn/drawn_layout.h"]
    assert includes_of_later_rooms("layout", Path("native/layout/a.h"), text) == ["layout/drawn/drawn_layout.h", "layout/curves/surface_paths.h"]


def test_an_upward_include_is_seen():
    assert upward_includes("surface", '#include "base/error.h"\n#include "remesh/remesh.h"\n#include <vector>\n') == ["remesh/remesh.h"]


def test_cgal_stays_in_source_files_and_opensubdiv_in_its_layer():
    cgal = [str(path) for path in NATIVE if path.suffix == ".h" and re.search(r"#\s*include\s*<CGAL/", text_of(path))]
    subdivision = [str(path) for path in NATIVE if path.parts[1] != "subdivision" and re.search(r"#\s*include\s*<opensubdiv/", text_of(path))]
    assert (cgal, subdivision) == ([], [])


def test_core_imports_no_blender():
    """Not even inside a function: what needs Blender is handed in."""
    blender = {"bpy", "bmesh", "mathutils", "gpu", "blf", "bpy_extras", "addon_utils"}
    wrong = {}
    for path in CORE:
        found = [name for name in imported_modules(path, text_of(path)) if name.split(".")[0] in blender]
        # The rest of the add-on may import Blender, so that what imports it does.
        found += imports_outside(["addon.core", "addon._native"], path, text_of(path))
        if found:
            wrong[str(path)] = found
    assert wrong == {}


def test_the_bridge_knows_nothing_of_what_crosses_it():
    bridge = [path for path in files() if path.parts[:2] == ("addon", "bridge") and path.suffix == ".py"]
    below = ["addon.core", "addon.bridge", "addon.compat", "addon._native"]
    wrong = {str(path): imports_outside(below, path, text_of(path)) for path in bridge}
    assert bridge and {path: names for path, names in wrong.items() if names} == {}


@pytest.mark.parametrize(
    "line, name",
    [
        ("from ..bridge import blend_files", "addon.bridge"), ("from .. import registration", "addon.registration"), ("from .. import bridge", "addon.bridge"),
        ("from ..bridge.meshes import new_mesh", "addon.bridge.meshes"), ("def later():\n    from ..bridge import meshes", "addon.bridge"),
    ],
)  # fmt: skip
def test_a_relative_import_is_seen(line, name):
    assert imports_outside(["addon.core", "addon._native"], Path("addon/core/worker.py"), line) == [name]
    allowed = "import json\nfrom . import report\nfrom .native import native\nfrom .. import _native\n"
    assert imports_outside(["addon.core", "addon._native"], Path("addon/core/worker.py"), allowed) == []


def test_the_python_module_has_every_limit():
    limits = re.findall(r"^inline constexpr \S+ (\w+) =", text_of("native/base/limits.h"), re.MULTILINE)
    assert limits == re.findall(r'^  all\["(\w+)"\] = limits::\1;', text_of("native/bindings/limits.cpp"), re.MULTILINE) != []


def test_only_compat_asks_for_the_version():
    addon = [path for path in files() if path.parts[0] == "addon" and path.suffix == ".py" and path.name != "compat.py"]
    assert [str(path) for path in addon if "bpy.app.version" in text_of(path)] == []


MOST_LINES = 500  # more than that no reader holds in mind


def test_no_source_file_is_too_long():
    assert [str(path) for path in files() if path.suffix in SOURCE and text_of(path).count("\n") > MOST_LINES] == []


def test_every_source_file_names_the_licence():
    sources = [path for path in files() if path.suffix in SOURCE or path.parts[0] == "scripts" or path.name == "CMakeLists.txt"]
    missing = [str(path) for path in sources if text_of(path).strip() and "SPDX-License-Identifier: GPL-3.0-or-later" not in text_of(path)[:300]]
    assert missing == []


def test_no_file_names_a_machine():
    """Nothing that is true on one machine only, or of the people and tools at work on it, belongs in the project."""
    machine = re.compile(
        "|".join([r"/" + r"work/", r"/" + r"root/", r"/" + r"home/\w", r"/" + r"Users/\w", r"/" + r"tmp/ifc", r"shared/" + r"(design|style|blender_facts)"])
    )
    found = [f"{path}: {match[0]}" for path in files() if path != Path("LICENSE") for match in [machine.search(text_of(path))] if match]
    assert found == []


def text_chunks(image):
    """The keywords of what a PNG says in words: renderers write paths and dates there."""
    found, at = [], 8
    while at < len(image):
        length, kind = int.from_bytes(image[at : at + 4], "big"), image[at + 4 : at + 8]
        if kind in {b"tEXt", b"zTXt", b"iTXt"}:
            found.append(image[at + 8 : at + 8 + length].split(b"\0")[0].decode("latin-1"))
        at += 12 + length
    return found


def test_pictures_say_nothing_of_the_machine_that_made_them():
    pictures = [path for path in files() if path.suffix == ".png"]
    assert pictures
    assert {str(path): chunks for path in pictures if (chunks := text_chunks((ROOT / path).read_bytes()))} == {}


def test_the_words_of_a_picture_are_seen():
    chunk = b"File\0a path"
    assert text_chunks(bytes(8) + len(chunk).to_bytes(4, "big") + b"tEXt" + chunk + bytes(4)) == ["File"]


def test_the_version_is_the_same_everywhere():
    version = re.search(r"project\(hybrid_mesh VERSION ([\d.]+)", text_of("CMakeLists.txt"))[1]
    assert re.search(r'^version = "([^"]+)"', text_of("addon/blender_manifest.toml"), re.MULTILINE)[1] == version
    numbers = re.search(r'"version": \(([\d, ]+)\)', text_of("addon/__init__.py"))[1]
    assert numbers.replace(" ", "").replace(",", ".") == version


def test_scripts_are_executable():
    scripts = [path for path in files() if path.parent == Path("scripts") and not path.suffix] + [Path(".ci/run")]
    assert [str(path) for path in scripts if not (ROOT / path).stat().st_mode & 0o111] == []
