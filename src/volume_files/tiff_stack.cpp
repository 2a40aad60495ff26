// SPDX-License-Identifier: Apache-2.0
#include "volume_files/tiff_stack.h"

#include <memory>
#include <utility>

#include "files/file_error.h"

namespace isoatlas::detail::io {

void set_page_order(TiffStack& stack, const std::string& axes, std::vector<std::size_t> pages) {
  std::array<std::size_t, 3> step{};  // between channels, slices and times
  std::size_t product = 1;
  for (const char axis : axes) {
    const std::size_t axis_index = axis == 'C' ? 0 : axis == 'Z' ? 1 : 2;
    step[axis_index] = product;
    product *= axis == 'C' ? stack.channels : axis == 'Z' ? stack.slices : stack.times;
  }
  stack.page_of = [step, is_contiguous = stack.is_contiguous,
                   pages = std::make_shared<const std::vector<std::size_t>>(std::move(pages))](
                      std::size_t channel, std::size_t slice, std::size_t time) {
    const std::size_t page = channel * step[0] + slice * step[1] + time * step[2];
    return is_contiguous ? page : pages->at(page);
  };
}

std::vector<std::size_t> pages_without_previews(TiffFile& tiff, VolumeSource& source,
                                                const std::function<void(std::size_t)>& at_page) {
  std::vector<std::size_t> pages;
  for (std::size_t page = 0; page < tiff.page_count(); ++page) {
    tiff.select(page);
    if (tiff.is_preview()) continue;
    if (at_page) at_page(pages.size());
    pages.push_back(page);
  }
  if (pages.empty()) {
    throw unsupported(
        tiff.path(),
        "has previews and masks of other pages only (NewSubfileType), expected slices");
  }
  if (pages.size() < tiff.page_count()) {
    source.decisions.push_back({"previews", std::to_string(tiff.page_count() - pages.size()) +
                                                " reduced pages or masks ignored"});
  }
  return pages;
}

}  // namespace isoatlas::detail::io
