// SPDX-License-Identifier: Apache-2.0
#include "view/messages.h"

#include <nlohmann/json.hpp>

namespace isoatlas::detail::tool {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::chrono::milliseconds kInterval{50};

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string message(std::string_view type, std::int64_t request) {
  return text_of({{"type", type}, {"request", request}});
}

std::string failure(std::int64_t request, std::string_view text) {
  return text_of({{"type", "failed"}, {"request", request}, {"message", text}});
}

std::string mesh_message(std::int64_t request, std::uint64_t id, std::size_t reduction,
                         bool is_final) {
  return text_of({{"type", "mesh"},
                  {"request", request},
                  {"id", id},
                  {"reduction", reduction},
                  {"final", is_final}});
}

std::string saved_message(std::int64_t request, const SavedFile& file) {
  return text_of({{"type", "saved"},
                  {"request", request},
                  {"id", file.id},
                  {"name", file.name},
                  {"bytes", file.bytes},
                  {"satisfied", file.satisfied},
                  {"summary", file.summary}});
}

std::string goodbye(std::string_view text) { return text_of({{"type", "bye"}, {"message", text}}); }

void ProgressMessages::show(std::string_view stage, std::optional<double> fraction) {
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < kInterval) return;
  last_ = now;
  Json json{{"type", "progress"}, {"request", request_}, {"stage", stage}};
  json["fraction"] = fraction ? Json(*fraction) : Json();
  events_.send(text_of(json));
}

}  // namespace isoatlas::detail::tool
