// SPDX-License-Identifier: Apache-2.0
#include "mask.h"

#include <algorithm>

#include "interruptible.h"
#include "isoatlas/error.h"
#include "isoatlas/mask_field.h"

namespace isoatlas::detail::python {
namespace {

MaskConnectivity connectivity_named(const std::string& name) {
  if (name == "18") return MaskConnectivity::inside_18;
  if (name == "6") return MaskConnectivity::inside_6;
  if (name == "field") return MaskConnectivity::field;
  throw Error(ErrorCode::bad_argument,
              "connectivity: expected 18, 6 or 'field', got '" + name + "'");
}

}  // namespace

py::array mask_field_of(const ArrayVolume& labels, const std::vector<std::int64_t>& wanted,
                        const std::string& connectivity, int threads, const py::object& progress) {
  const MaskFieldOptions options{connectivity_named(connectivity)};
  const Volume field = compute_interruptibly(
      [view = labels.view(), wanted, options](const RunControl& control) {
        return mask_field(mask_of_labels(view, wanted), options, control);
      },
      {.progress = progress, .threads = threads, .keep_alive = labels.array});
  const std::vector<py::ssize_t> shape(labels.array.shape(),
                                       labels.array.shape() + labels.array.ndim());
  std::vector<py::ssize_t> strides;
  for (py::ssize_t a = 0; a < labels.array.ndim(); ++a)
    strides.push_back(labels.array.strides(a) / labels.array.itemsize() *
                      static_cast<py::ssize_t>(sizeof(float)));
  py::array out(py::dtype::of<float>(), shape, strides);
  const auto* samples = static_cast<const float*>(field.view.samples);
  std::copy_n(samples, field.view.grid.sample_count(), static_cast<float*>(out.mutable_data()));
  return out;
}

}  // namespace isoatlas::detail::python
