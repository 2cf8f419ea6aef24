# SPDX-License-Identifier: GPL-3.0-or-later
import os
import types

import batches
import pytest

# Tasks run in folders of their own.
os.environ["PYTHONPATH"] = os.pathsep.join(os.path.abspath(path) for path in os.environ.get("PYTHONPATH", "").split(os.pathsep) if path)


@pytest.fixture(scope="session")
def scans(tmp_path_factory):
    """A folder of scans, which of them are bad, and what one machine makes of them."""
    folder = tmp_path_factory.mktemp("batch")
    good, bad = batches.write_inputs(folder / "scans")
    alone = batches.remesh_alone(folder / "scans", folder / "alone")
    assert alone.returncode == 1 and alone.stdout.splitlines()[-1].startswith(f"{len(good) + len(bad)} inputs: {len(good)} done, {len(bad)} failed"), alone.stderr
    return types.SimpleNamespace(folder=folder / "scans", alone=folder / "alone", good=good, bad=bad, count=len(good) + len(bad))
