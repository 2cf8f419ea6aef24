// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/limits.h"

#include "bindings/bindings.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

py::dict all_limits() {
  py::dict all;
  all["most_vertices"] = limits::most_vertices;
  all["end_of_error"] = limits::end_of_error;
  all["end_of_drop_components"] = limits::end_of_drop_components;
  all["end_of_remove_noise"] = limits::end_of_remove_noise;
  all["most_levels"] = limits::most_levels;
  all["most_base_quads"] = limits::most_base_quads;
  all["least_stretch_threshold"] = limits::least_stretch_threshold;
  all["most_stretch_threshold"] = limits::most_stretch_threshold;
  all["least_feature_angle"] = limits::least_feature_angle;
  all["most_feature_angle"] = limits::most_feature_angle;
  all["most_seed"] = limits::most_seed;
  all["most_threads"] = limits::most_threads;
  all["most_cubes"] = limits::most_cubes;
  all["most_even_quads"] = limits::most_even_quads;
  all["most_buffer_rings"] = limits::most_buffer_rings;
  all["most_snap"] = limits::most_snap;
  return all;
}

}  // namespace

void bind_limits(py::module_& module) {
  module.def("limits", &all_limits,
             "How far settings and plans may go, by name: `most_` and `least_` are allowed themselves, what has an `end_of_` stays below it.");
}

}  // namespace hybrid_mesh
