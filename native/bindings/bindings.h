// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace hybrid_mesh {

// What each file of this folder adds to the module.
void bind_errors(pybind11::module_& module);
void bind_limits(pybind11::module_& module);
void bind_mesh_io(pybind11::module_& module);
void bind_hierarchy(pybind11::module_& module);
void bind_subdivision(pybind11::module_& module);    // a method of bind_hierarchy's class
void bind_modelling(pybind11::module_& module);      // the same
void bind_region_update(pybind11::module_& module);  // the same
void bind_wavelets(pybind11::module_& module);       // the same
void bind_streams(pybind11::module_& module);        // the same
void bind_remesh(pybind11::module_& module);
void bind_job(pybind11::module_& module);
void bind_topology(pybind11::module_& module);
void bind_drawn_layout(pybind11::module_& module);

}  // namespace hybrid_mesh
