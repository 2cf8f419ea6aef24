# SPDX-License-Identifier: GPL-3.0-or-later
"""The decoder, built alone with a compiler and nothing else, against the library: bit for bit."""

import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from hybrid_mesh import _native

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def decode_stream(tmp_path_factory):
    """The program of decode_stream.c, made of a copy of the decoder beside which there is nothing that it could include."""
    folder = tmp_path_factory.mktemp("alone")
    shutil.copytree(ROOT / "native/decoder", folder / "decoder")
    shutil.copy(Path(__file__).with_name("decode_stream.c"), folder)

    def compiled(source):
        language = ["gcc", "-std=c11", "-Wall", "-Werror"] if source.suffix == ".c" else ["g++", "-std=c++20"]
        made = source.with_suffix(".o")
        subprocess.run([*language, "-O1", "-I", folder, "-c", source, "-o", made], check=True)
        return made

    with ThreadPoolExecutor(2) as pool:
        objects = list(pool.map(compiled, [folder / "decode_stream.c", *sorted(folder.glob("decoder/**/*.cpp"))]))
    subprocess.run(["g++", *objects, "-o", folder / "decode_stream"], check=True)

    def run(path, most_bytes=0, level=-1):
        done = subprocess.run([folder / "decode_stream", path, str(most_bytes), str(level)], capture_output=True)
        if done.returncode:
            raise ValueError(done.returncode, done.stderr.decode())
        vertices, faces, corners = np.frombuffer(done.stdout, np.uint64, 3)
        arrays, at = {}, 24
        for name, kind, count in (("points", np.float64, 3 * vertices), ("offsets", np.int64, faces + 1), ("indices", np.int32, corners)):
            arrays[name] = np.frombuffer(done.stdout, kind, int(count), at)
            at += arrays[name].nbytes
        assert at == len(done.stdout)
        return arrays

    return run


def same(alone, library):
    return all(np.array_equal(alone[key], np.asarray(library[key]).ravel()) for key in ("points", "offsets", "indices"))


def test_it_decodes_what_the_library_decodes(decode_stream, hierarchy, tmp_path):
    path = tmp_path / "a.hmesh"
    size = hierarchy.save_stream(path, exact=True)
    for most_bytes in (size // 9, size // 2, size):
        loaded = _native.load_hierarchy(path, most_bytes=most_bytes)
        assert same(decode_stream(path, most_bytes), loaded.final_mesh())
        for level, name in enumerate(name for name in loaded.level_names if name.startswith("N")):
            assert same(decode_stream(path, most_bytes, level), loaded.level(name)), name


def test_it_says_what_is_wrong(decode_stream, hierarchy, tmp_path):
    path = tmp_path / "a.hmesh"
    hierarchy.save_stream(path, exact=True)
    with pytest.raises(ValueError, match="11, .*ends before its base"):
        decode_stream(path, 20)
    path.write_bytes(b"HMw\x02" + bytes(20))
    with pytest.raises(ValueError, match="12, .*newer"):
        decode_stream(path)
    path.write_bytes(b"ply\n")
    with pytest.raises(ValueError, match="11, .*other bytes"):
        decode_stream(path)
