// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <string>

#include "base/error.h"
#include "bindings/bindings.h"
#include "bindings/layout_problems.h"

namespace py = pybind11;

namespace hybrid_mesh {
namespace {

// Exception classes by ErrorCode. The references are never given back: a translator may run as long as the interpreter does.
std::array<PyObject*, 6> exception_classes{};
PyObject* layout_error = nullptr;

PyObject* new_exception(py::module_& module, const char* name, PyObject* base) {
  const std::string qualified = module.attr("__name__").cast<std::string>() + "." + name;
  PyObject* type = PyErr_NewException(qualified.c_str(), base, nullptr);
  if (!type) throw py::error_already_set();
  module.attr(name) = py::handle(type);
  return type;
}

}  // namespace

void bind_errors(py::module_& module) {
  PyObject* base = new_exception(module, "Error", PyExc_Exception);
  const auto add = [&](ErrorCode code, const char* name) { exception_classes[static_cast<std::size_t>(code)] = new_exception(module, name, base); };
  add(ErrorCode::InvalidInput, "InvalidInput");
  add(ErrorCode::Unsupported, "Unsupported");
  add(ErrorCode::Cancelled, "Cancelled");
  add(ErrorCode::CorruptStream, "CorruptStream");
  add(ErrorCode::Io, "IoError");
  add(ErrorCode::Internal, "InternalError");
  layout_error = new_exception(module, "LayoutError", exception_classes[static_cast<std::size_t>(ErrorCode::InvalidInput)]);
  py::register_local_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const LayoutError& error) {
      PyErr_SetObject(layout_error, py::make_tuple(error.what(), to_list(error.problems)).ptr());
    } catch (const Error& error) {
      PyErr_SetString(exception_classes[static_cast<std::size_t>(error.code())], error.what());
    }
  });
}

}  // namespace hybrid_mesh
