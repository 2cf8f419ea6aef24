// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings/bindings.h"

PYBIND11_MODULE(_native, module) {
  module.doc() = "The native library of Hybrid Mesh. A mesh is points (n, 3), face_offsets (m + 1,) and face_indices (k,).";
  module.attr("__version__") = HYBRID_MESH_VERSION;
  hybrid_mesh::bind_errors(module);
  hybrid_mesh::bind_limits(module);
  hybrid_mesh::bind_mesh_io(module);
  hybrid_mesh::bind_hierarchy(module);
  hybrid_mesh::bind_subdivision(module);
  hybrid_mesh::bind_modelling(module);
  hybrid_mesh::bind_region_update(module);
  hybrid_mesh::bind_wavelets(module);
  hybrid_mesh::bind_streams(module);
  hybrid_mesh::bind_remesh(module);
  hybrid_mesh::bind_job(module);
  hybrid_mesh::bind_topology(module);
  hybrid_mesh::bind_drawn_layout(module);
}
