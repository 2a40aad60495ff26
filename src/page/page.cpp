// SPDX-License-Identifier: Apache-2.0
#include "page/page.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "isoatlas/error.h"
#include "isoatlas/version.h"
#include "mesh_files/base64.h"
#include "page/assets.h"
#include "page/geometry.h"

namespace isoatlas::detail {
namespace {

using Json = nlohmann::ordered_json;

std::string in_html(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else
      out += c;
  }
  return out;
}

// JSON that is safe inside a script element. '<' occurs only in strings, where it can be escaped.
std::string in_script(const Json& json) {
  std::string out;
  for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  }
  return out;
}

// The start of a page, up to the content of its body.
std::string beginning(const std::string& title, std::string_view style) {
  std::string out =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"generator\" content=\"isoatlas " ISOATLAS_VERSION "\">\n<title>";
  out += in_html(title);
  out += "</title>\n<style>\n";
  out += style;
  out += "\n</style>\n</head>\n<body>\n";
  return out;
}

// The end of a page, with its script.
std::string ending(std::string_view script) {
  std::string out = "<script>\n";
  out += script;
  out += "\n</script>\n</body>\n</html>\n";
  return out;
}

}  // namespace

void require_pages() {
  if (page::script().empty())
    throw Error(ErrorCode::unsupported,
                "this isoatlas was built without pages (ISOATLAS_BUILD_PAGE)");
}

std::string page_html(std::span<const PageEntry> entries, const std::filesystem::path& path) {
  require_pages();
  Json json = {{"schema", "isoatlas-page-2"}, {"version", ISOATLAS_VERSION}};
  Json& results = json["results"] = Json::array();
  std::string geometry, title;
  for (const PageEntry& entry : entries) {
    Json result = Json::parse(entry.facts);
    result["geometry"] = page::append_geometry(entry.hierarchy, path, geometry);
    title += (title.empty() ? "" : ", ") + result["title"].get<std::string>();
    results.push_back(std::move(result));
  }
  std::string out = beginning(title + " - isoatlas", page::style());
  out +=
      "<noscript>This page shows meshes in 3-D and needs JavaScript. It loads nothing from "
      "anywhere.</noscript>\n"
      "<script type=\"application/json\" id=\"isoatlas-data\">";
  out += in_script(json);
  out += "</script>\n<script type=\"text/plain\" id=\"isoatlas-geometry\">";
  out += io::to_base64(geometry);
  out += "</script>\n";
  out += ending(page::script());
  return out;
}

std::string view_html() {
  require_pages();
  return beginning("isoatlas view", page::view_style()) +
         "<noscript>This page shows a volume and its isosurfaces, and needs "
         "JavaScript.</noscript>\n" +
         ending(page::view_script());
}

}  // namespace isoatlas::detail
