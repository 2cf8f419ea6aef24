// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings/remesh.h"

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "base/limits.h"
#include "bindings/bindings.h"
#include "bindings/conversions.h"
#include "bindings/job.h"
#include "codec/container.h"
#include "surface/topology_summary.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

// One entry of the settings, with the messages about it.
class Setting {
 public:
  Setting(std::string key, py::handle value) : key_(std::move(key)), value_(value) {}

  std::int64_t whole_number(std::int64_t least, std::int64_t most) const {
    // Whatever has __index__, numpy's integers too, but no bool.
    if (py::isinstance<py::bool_>(value_) || !PyIndex_Check(value_.ptr())) refuse("a whole number");
    const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(value_.ptr()));
    if (!index) throw py::error_already_set();
    int overflow = 0;
    const long long number = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
    if (overflow != 0 || number < least || number > most) refuse("from " + std::to_string(least) + " to " + std::to_string(most));
    return number;
  }

  double number() const {
    if (py::isinstance<py::bool_>(value_) || !PyNumber_Check(value_.ptr()) || py::isinstance<py::str>(value_)) refuse("a number");
    const double number = PyFloat_AsDouble(value_.ptr());
    if (PyErr_Occurred()) throw py::error_already_set();
    if (!std::isfinite(number)) refuse("a finite number");
    return number;
  }

  double number(double least, double most) const {
    const double value = number();
    if (value < least || value > most) refuse("from " + text_of(least) + " to " + text_of(most));
    return value;
  }

  // At least 0.
  double number_below(double end) const {
    const double value = number();
    if (value < 0 || value >= end) refuse("at least 0 and below " + text_of(end));
    return value;
  }

  bool flag() const {
    if (!py::isinstance<py::bool_>(value_)) refuse("True or False");
    return value_.cast<bool>();
  }

  std::string text() const {
    if (!py::isinstance<py::str>(value_)) refuse("text");
    return value_.cast<std::string>();
  }

  // An axis, or a normal and the plane's offset along it.
  MirrorPlane plane() const {
    MirrorPlane plane;
    for (int i = 0; i < 3; ++i)
      if (is(std::string(1, "xyz"[i]).c_str())) return {Vec3::Unit(i), 0};
    const std::string expected = "'none', 'auto', 'x', 'y', 'z' or four numbers, a normal and an offset";
    if (!py::isinstance<py::sequence>(value_) || py::isinstance<py::str>(value_) || py::len(value_) != 4) refuse(expected);
    std::array<double, 4> numbers;
    for (std::size_t i = 0; i < 4; ++i) {
      const py::object number = value_.attr("__getitem__")(i);
      if (!PyFloat_Check(number.ptr()) && !PyLong_Check(number.ptr())) refuse(expected);
      numbers[i] = PyFloat_AsDouble(number.ptr());
      if (PyErr_Occurred()) throw py::error_already_set();
    }
    plane.normal = {numbers[0], numbers[1], numbers[2]};
    const double length = plane.normal.stableNorm();
    if (!std::isfinite(length) || !std::isfinite(numbers[3]) || !(length > 0)) refuse(expected);
    plane.normal /= length;
    plane.offset = numbers[3] / length;
    return plane;
  }

  bool is(const char* word) const { return py::isinstance<py::str>(value_) && value_.cast<std::string>() == word; }

  [[noreturn]] void refuse(const std::string& expected) const {
    throw Error(ErrorCode::InvalidInput, "the setting " + key_ + " must be " + expected + ", not " + py::repr(value_).cast<std::string>());
  }

 private:
  static std::string text_of(double value) { return py::str(py::float_(value)).cast<std::string>(); }

  std::string key_;
  py::handle value_;
};

void apply(RemeshOptions& options, const std::string& key, const Setting& setting) {
  if (key == "vertices") {
    options.vertices = setting.whole_number(0, limits::most_vertices);
  } else if (key == "error") {
    options.error = setting.number_below(limits::end_of_error);
  } else if (key == "levels") {
    options.levels = static_cast<int>(setting.whole_number(-1, limits::most_levels));
  } else if (key == "refinement") {
    if (setting.is("uniform"))
      options.refinement = Refinement::Uniform;
    else if (setting.is("adaptive"))
      options.refinement = Refinement::Adaptive;
    else
      setting.refuse("'uniform' or 'adaptive'");
  } else if (key == "faces") {
    if (setting.is("quads"))
      options.faces = FaceClosure::Quads;
    else if (setting.is("transition"))
      options.faces = FaceClosure::Transition;
    else if (setting.is("triangles"))
      options.faces = FaceClosure::Triangles;
    else
      setting.refuse("'quads', 'transition' or 'triangles'");
  } else if (key == "features") {
    if (setting.is("auto")) {
      options.features = Features::Auto;
    } else if (setting.is("none")) {
      options.features = Features::None;
    } else {
      options.features = Features::Given;
      options.feature_angle = setting.number(limits::least_feature_angle, limits::most_feature_angle);
    }
  } else if (key == "base") {
    if (setting.is("auto")) {
      options.base = BaseSize::Auto;
    } else if (setting.is("min")) {
      options.base = BaseSize::Minimal;
    } else {
      options.base = BaseSize::Given;
      options.base_quads = static_cast<int>(setting.whole_number(1, limits::most_base_quads));
    }
  } else if (key == "topology") {
    if (setting.is("auto"))
      options.topology = TopologyMode::Auto;
    else if (setting.is("late"))
      options.topology = TopologyMode::Late;
    else if (setting.is("base"))
      options.topology = TopologyMode::Base;
    else
      setting.refuse("'auto', 'late' or 'base'");
  } else if (key == "components") {
    if (setting.is("apart"))
      options.components = Components::Apart;
    else if (setting.is("joined"))
      options.components = Components::Joined;
    else
      setting.refuse("'apart' or 'joined'");
  } else if (key == "symmetry") {
    if (setting.is("none")) {
      options.symmetry = Symmetry::None;
    } else if (setting.is("auto")) {
      options.symmetry = Symmetry::Auto;
    } else {
      options.symmetry = Symmetry::Given;
      options.mirror = setting.plane();
    }
  } else if (key == "symmetry_side") {
    if (setting.is("positive"))
      options.symmetry_side = SymmetrySide::Positive;
    else if (setting.is("negative"))
      options.symmetry_side = SymmetrySide::Negative;
    else if (setting.is("average"))
      options.symmetry_side = SymmetrySide::Average;
    else
      setting.refuse("'positive', 'negative' or 'average'");
  } else if (key == "remove_noise") {
    options.remove_noise = setting.number_below(limits::end_of_remove_noise);
  } else if (key == "stretch_threshold") {
    options.stretch_threshold = setting.number(limits::least_stretch_threshold, limits::most_stretch_threshold);
  } else if (key == "semi_regular") {
    options.semi_regular = setting.flag();
  } else if (key == "effort") {
    if (setting.is("quick"))
      options.effort = Effort::Quick;
    else if (setting.is("normal"))
      options.effort = Effort::Normal;
    else if (setting.is("thorough"))
      options.effort = Effort::Thorough;
    else
      setting.refuse("'quick', 'normal' or 'thorough'");
  } else if (key == "drop_components") {
    options.drop_components = setting.number_below(limits::end_of_drop_components);
  } else if (key == "density") {
    options.density = setting.text();
  } else if (key == "plan") {
    options.plan = setting.text();
  } else if (key == "strict") {
    options.strict = setting.flag();
  } else if (key == "seed") {
    options.seed = static_cast<std::uint64_t>(setting.whole_number(0, limits::most_seed));
  } else if (key == "threads") {
    options.threads = static_cast<int>(setting.whole_number(0, limits::most_threads));
  } else {
    throw Error(ErrorCode::InvalidInput, "there is no setting " + key);
  }
}

PythonResult remesh_and_wait(const py::object& points, const py::object& offsets, const py::object& indices, const py::dict& settings,
                             const py::object& density) {
  const RemeshOptions options = remesh_options_from_dict(settings);
  PolygonSoup soup = soup_from_arrays(points, offsets, indices, density);
  return PythonResult(run_interruptibly([&](Context& context) { return std::make_shared<RemeshResult>(remesh(std::move(soup), options, context)); }));
}

py::dict final_mesh(const PythonResult& result) {
  return to_dict(without_gil([&] { return result.hierarchy.annotated([](const HybridMesh& mesh) { return mesh.final_mesh(); }); }));
}

void save(const PythonResult& result, const py::object& path_object, const std::string& metadata) {
  const std::string path = path_from_python(path_object);
  without_gil([&] { result.hierarchy.locked([&](const HybridMesh& mesh) { save_hierarchy(mesh, metadata, path); }); });
}

}  // namespace

RemeshOptions remesh_options_from_dict(const py::dict& settings) {
  RemeshOptions options;
  for (const auto& [key, value] : settings) {
    if (!py::isinstance<py::str>(key))
      throw Error(ErrorCode::InvalidInput, "a setting's name must be text, not " + py::repr(key).cast<std::string>());
    const auto name = key.cast<std::string>();
    apply(options, name, Setting(name, value));
  }
  return options;
}

void bind_remesh(py::module_& module) {
  using py::arg;
  py::class_<PythonResult>(module, "Result", "What a remesh gives.")
      .def_property_readonly(
          "report",
          [](const PythonResult& result) { return result.result->report.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace); },
          "JSON text.")
      .def_property_readonly(
          "plan", [](const PythonResult& result) { return result.result->plan; },
          "JSON text: what decided the quads. With it as a setting the same surface is remeshed in the same way, and others alike.")
      .def_readonly("hierarchy", &PythonResult::hierarchy, "The levels.")
      .def("final_mesh", &final_mesh, "The remesh, as a dict of arrays.")
      .def(
          "repaired", [](const PythonResult& result) { return soup_to_arrays(to_soup(result.result->repaired)); },
          "The triangle surface that was remeshed: (points, face_offsets, face_indices).")
      .def_property_readonly(
          "repaired_source_faces", [](const PythonResult& result) { return to_array(result.result->repaired.source_face); },
          "For each face of the repaired surface the triangle of the input, as it was triangulated.")
      .def("save", &save, arg("path"), arg("metadata") = "", "Writes the hierarchy with its maps.");
  module.def("remesh", &remesh_and_wait, arg("points"), arg("face_offsets"), arg("face_indices"), arg("settings") = py::dict(),
             arg("density") = py::none(),
             "Remeshes and returns the Result; Ctrl-C ends it. density: one value in [0, 1] a point, of the attribute that the setting `density` "
             "names: 1 for edges 1/4 as long as at 0.5, 0 for edges 4 times as long.");
}

}  // namespace hybrid_mesh
