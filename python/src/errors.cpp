// SPDX-License-Identifier: Apache-2.0
#include "errors.h"

#include <new>
#include <string>

#include "isoatlas/error.h"

namespace isoatlas::detail::python {
namespace {

namespace py = pybind11;

const char* class_name(ErrorCode code) {
  switch (code) {
    case ErrorCode::bad_argument:
      return "BadArgumentError";
    case ErrorCode::bad_file:
      return "BadFileError";
    case ErrorCode::unsupported:
      return "UnsupportedError";
    case ErrorCode::empty_surface:
      return "EmptySurfaceError";
    case ErrorCode::internal:
    case ErrorCode::cancelled:  // run_interruptibly() throws the exception that caused it
      return "InternalError";
    case ErrorCode::out_of_memory:
      return "OutOfMemoryError";
  }
  return "InternalError";
}

std::string error_text(const Error& error) {
  switch (error.remedy()) {
    case Remedy::place_nan:
      return error.problem() +
             ": set nan='below' or nan='above', the side of the isovalue on which NaN lies";
    case Remedy::only_coarse:
      return error.problem() + "; use coarse=True, or resample the volume to a box-shaped grid";
    case Remedy::allow_memory:
      return error.problem() + "; max_memory allows more";
    case Remedy::none:
      break;
  }
  return error.what();
}

void set_error(ErrorCode code, const std::string& message) {
  std::string text = message;
  if (code == ErrorCode::internal)
    text += ". This is a bug of isoatlas: please report it with the input";
  // A path in the message may hold bytes that are not UTF-8.
  const auto decoded = py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "surrogateescape"));
  const py::object type = py::module_::import("isoatlas.errors").attr(class_name(code));
  PyErr_SetObject(type.ptr(), decoded.ptr());
}

}  // namespace

void translate_errors() {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      set_error(error.code(), error_text(error));
    } catch (const std::bad_alloc&) {
      set_error(ErrorCode::out_of_memory, "out of memory");
    }
  });
}

}  // namespace isoatlas::detail::python
