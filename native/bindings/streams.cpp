// SPDX-License-Identifier: GPL-3.0-or-later
// Hierarchies as embedded streams.
#include <string>
#include <vector>

#include "bindings/bindings.h"
#include "bindings/conversions.h"
#include "bindings/hierarchy.h"
#include "bindings/job.h"
#include "codec/file_bytes.h"
#include "codec/stream.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

std::size_t save_stream(const PythonHierarchy& hierarchy, const py::object& path_object, std::size_t most_bytes, double error, bool exact,
                        const py::object& surface) {
  const std::string path = path_from_python(path_object);
  if (!(error >= 0 && error < 1)) throw Error(ErrorCode::InvalidInput, "error must be at least 0 and below 1");
  StreamOptions options{most_bytes, error, exact ? StreamFit::None : StreamFit::Auto, nullptr};
  if (!surface.is_none()) {
    const auto arrays = surface.cast<std::vector<py::object>>();
    if (arrays.size() != 3) throw Error(ErrorCode::InvalidInput, "surface must be (points, face_offsets, face_indices)");
    options.surface = std::make_shared<const PolygonSoup>(soup_from_arrays(arrays[0], arrays[1], arrays[2]));
  }
  return run_interruptibly([&](Context& context) {
    const std::vector<std::uint8_t> bytes = hierarchy.locked([&](const HybridMesh& mesh) { return encode_stream(mesh, options, Progress(context)); });
    write_bytes(bytes, path);
    return bytes.size();
  });
}

constexpr const char* kSaveStream =
    R"(Writes the hierarchy as an embedded stream, of which every prefix that has the base whole can be loaded; returns its size.

path        the file, which appears when it is complete
most_bytes  of the file; 0: no bound
error       writes the shortest prefix whose final mesh has no larger L2 distance from the surface, or from this one's if none is given, as a fraction of the
            bounding-box diagonal; 0: all of it
exact       the whole of the stream has this final mesh; else its vertices are moved, for fewer bytes, to where it comes as close to the surface as before
surface     (points, face_offsets, face_indices) of the mesh that it is a remesh of; None: what the maps know of it. If there are none, or the final mesh has
            been edited, it is left as it is

A stream has connectivity and positions: the final mesh's, and on the other levels what analyse() leaves of those. Maps, metadata and what of the original
surface points carry are not in it; quads and vertices are in another order. Raises InvalidInput if the bound is too small for the base or a value is out of
range, Unsupported if an operation is switched off.)";

}  // namespace

void bind_streams(py::module_& module) {
  using py::arg;
  auto type = py::reinterpret_borrow<py::class_<PythonHierarchy>>(module.attr("Hierarchy"));
  type.def("save_stream", &save_stream, arg("path"), py::kw_only(), arg("most_bytes") = 0, arg("error") = 0.0, arg("exact") = false,
           arg("surface") = py::none(), kSaveStream);
}

}  // namespace hybrid_mesh
