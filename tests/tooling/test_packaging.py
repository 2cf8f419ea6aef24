# SPDX-License-Identifier: GPL-3.0-or-later
"""Which Pythons a module is built for, and what the modules that are packaged need."""

import importlib.machinery
import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
STAGE = ROOT / "build/stage/hybrid_mesh"
sys.dont_write_bytecode = True


def package():
    loader = importlib.machinery.SourceFileLoader("package_script", str(ROOT / "scripts/package"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


def interpreter(folder, name, answer, headers=True):
    """A program that answers as a Python of some version does."""
    folder.mkdir(parents=True, exist_ok=True)
    include = folder / f"include-{name}"
    if headers:
        include.mkdir()
        (include / "Python.h").touch()
    path = folder / name
    path.write_text(f"#!/bin/sh\n{answer.format(include=include)}\n")
    path.chmod(0o755)
    return path


def found(home, *folders):
    run = subprocess.run([ROOT / "scripts/pythons", *folders], env={"PATH": "/usr/bin:/bin", "HOME": str(home)}, capture_output=True, encoding="utf-8", check=True)
    return run.stdout.splitlines()


def test_an_interpreter_with_headers_is_found_once_for_each_version(tmp_path):
    given = interpreter(tmp_path / "given", "python3.13", "echo 3.13 {include}")
    interpreter(tmp_path / "later", "python3.13", "echo 3.13 {include}")
    kept = interpreter(tmp_path / ".pyenv/versions/3.10.2/bin", "python3.10", "echo 3.10 {include}")
    interpreter(tmp_path / "given", "python3.12", "echo 3.12 {include}")  # of no Blender
    assert found(tmp_path, tmp_path / "given", tmp_path / "later") == [str(kept), str(given)]


@pytest.mark.parametrize("answer, headers", [("echo 3.13 {include}", False), ("echo 3.12 {include}", True), ("exit 127", True), ("", True)])
def test_what_cannot_be_built_for_is_passed_over(tmp_path, answer, headers):
    interpreter(tmp_path / "wrong", "python3.13", answer, headers)
    right = interpreter(tmp_path / "right", "python3.13", "echo 3.13 {include}")
    assert found(tmp_path, tmp_path / "wrong") == [] and found(tmp_path, tmp_path / "wrong", tmp_path / "right") == [str(right)]


def test_the_distributions_own_module_is_packaged():
    tags = {re.fullmatch(r"_native\.cpython-(\d+)-x86_64-linux-gnu\.so", path.name)[1] for path in STAGE.glob("_native*.so")}
    assert "311" in tags and tags <= {"310", "311", "313"}


def test_what_the_zip_needs_is_what_the_documentation_says():
    needed = package().needed_versions(STAGE)
    text = (ROOT / "docs/limits.md").read_text("utf-8")
    assert f"glibc {needed['GLIBC']} " in text and f"GLIBCXX {needed['GLIBCXX']})" in text


def test_the_newest_version_is_the_largest_number(tmp_path):
    library = tmp_path / "a.so"
    source = tmp_path / "a.c"
    source.write_text("#include <math.h>\n#include <stdio.h>\ndouble a(double x) { printf(\"%f\", x); return exp(x); }\n")
    subprocess.run(["gcc", "-shared", "-fPIC", "-o", library, source, "-lm"], check=True)
    needed = package().needed_versions(tmp_path)
    # exp is of 2.29, printf of 2.2.5: the larger as text is the smaller.
    assert needed == {"GLIBC": "2.29"}
