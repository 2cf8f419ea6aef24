# SPDX-License-Identifier: GPL-3.0-or-later
"""These tests are about the Python around the compiled module: the package is staged with a stand-in for it, without bpy."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import pytest

ADDON = pathlib.Path(__file__).resolve().parents[2] / "addon"
_STAGE = pathlib.Path(tempfile.mkdtemp(prefix="hybrid-mesh-stage-"))
shutil.copytree(ADDON, _STAGE / "hybrid_mesh", ignore=shutil.ignore_patterns("__pycache__"))
shutil.copy(pathlib.Path(__file__).parent / "fake_native.py", _STAGE / "hybrid_mesh" / "_native.py")
sys.path.insert(0, str(_STAGE))

BOX = """v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 2
v 1 0 2
v 1 1 2
v 0 1 2
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
"""


def pytest_sessionfinish(session, exitstatus):
    shutil.rmtree(_STAGE, ignore_errors=True)


class CommandLine:
    """Runs `python -m hybrid_mesh` in a folder of its own."""

    def __init__(self, folder):
        self.folder = folder
        self.environment = {**os.environ, "PYTHONPATH": str(_STAGE), "PYTHONDONTWRITEBYTECODE": "1"}

    def box(self, name):
        path = self.folder / name
        path.write_text(BOX)
        return name

    def start(self, *arguments, **options):
        command = [sys.executable, "-m", "hybrid_mesh", *map(str, arguments)]
        return subprocess.Popen(
            command, cwd=self.folder, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8", **options
        )

    def run(self, *arguments, **options):
        process = self.start(*arguments, **options)
        process.out, process.err = process.communicate(timeout=60)
        assert "Traceback" not in process.err + process.out, process.err
        return process

    def outputs(self, folder="out"):
        return sorted(os.listdir(self.folder / folder)) if (self.folder / folder).is_dir() else None


@pytest.fixture
def command_line(tmp_path):
    return CommandLine(tmp_path)
