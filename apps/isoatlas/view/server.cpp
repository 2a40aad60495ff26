// SPDX-License-Identifier: Apache-2.0
#include "view/server.h"

#include <httplib.h>
#include <sys/socket.h>

#include <atomic>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "error_text.h"
#include "isoatlas/error.h"
#include "text.h"
#include "view/guard.h"
#include "view/page_options.h"
#include "view/viewed_volume.h"

namespace isoatlas::detail::tool {
namespace {

using Json = nlohmann::ordered_json;
using httplib::Request;
using httplib::Response;

// A page needs one connection for its events, and browsers open at most six to a server. Other
// programs of this computer can occupy some without the token, but not so easily all of them.
constexpr std::size_t kMostPages = 4;       // open at a time
constexpr std::size_t kThreads = 64;        // connections at a time
constexpr std::size_t kMostBody = 1 << 20;  // bytes
constexpr std::size_t kMostOptions = 2000;
constexpr std::chrono::milliseconds kHeartbeat{500};
constexpr const char* kBinary = "application/octet-stream";

/// The page may load nothing from elsewhere, and other pages may not embed it.
const httplib::Headers kHeaders{
    {"Cache-Control", "no-store"},
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval'; style-src "
     "'unsafe-inline'; img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; "
     "form-action 'none'; frame-ancestors 'none'"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Referrer-Policy", "no-referrer"},
    {"X-Content-Type-Options", "nosniff"},
    {"X-Frame-Options", "DENY"}};

/// Without SO_REUSEPORT, which httplib sets: another process could take the port over.
void set_socket_options(socket_t socket) {
  const int yes = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
}

void answer(Response& response, const Json& json, int status = 200) {
  response.status = status;
  response.set_content(json.dump(-1, ' ', false, Json::error_handler_t::replace),
                       "application/json");
}

void refuse(Response& response, int status, std::string_view why) {
  answer(response, {{"error", why}}, status);
}

/// Of the statuses that httplib itself answers with.
std::string_view status_text(int status) {
  switch (status) {
    case 400:
      return "the request: expected one of HTTP 1.1";
    case 404:
      return "there is nothing here";
    case 413:
      return "the body of the request: expected at most 1 MiB";
    default:
      return "the request cannot be answered";
  }
}

[[noreturn]] void refuse_body(const std::string& expected) {
  throw Error(ErrorCode::bad_argument, "the body of the request: expected " + expected);
}

/// The body of a POST. Forms of other sites cannot send this content type.
Json body_of(const Request& request) {
  if (!request.get_header_value("Content-Type").starts_with("application/json"))
    refuse_body("the content type application/json");
  Json body = Json::parse(request.body, nullptr, false);
  if (!body.is_object()) refuse_body("a JSON object");
  return body;
}

std::int64_t request_number(const Json& body) {
  const auto number = body.find("request");
  if (number == body.end() || !number->is_number_integer()) refuse_body("the number 'request'");
  return number->get<std::int64_t>();
}

PageOptions options_of(const Json& body) {
  constexpr const char* kExpected = "'options', a list of pairs of texts";
  const auto options = body.find("options");
  if (options == body.end() || !options->is_array() || options->size() > kMostOptions)
    refuse_body(kExpected);
  PageOptions out;
  for (const Json& option : *options) {
    if (!option.is_array() || option.size() != 2 || !option[0].is_string() ||
        !option[1].is_string())
      refuse_body(kExpected);
    out.emplace_back(option[0].get<std::string>(), option[1].get<std::string>());
  }
  return out;
}

std::string format_of(const Json& body) {
  const auto format = body.find("format");
  if (format == body.end() || !format->is_string()) refuse_body("the text 'format'");
  return format->get<std::string>();
}

std::uint64_t whole(const std::string& digits) {
  std::uint64_t out = ~std::uint64_t{0};
  std::from_chars(digits.data(), digits.data() + digits.size(), out);
  return out;
}

/// Sends a file in pieces.
void send_file(Response& response, const Saver::Saved& saved) {
  const auto file = std::make_shared<std::ifstream>(saved.path, std::ios::binary);
  const std::uintmax_t size = std::filesystem::file_size(saved.path);
  std::string quoted;
  for (const char c : saved.name)
    quoted += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  response.set_header("Content-Disposition", "attachment; filename=\"" + quoted + "\"");
  response.set_content_provider(
      size, kBinary, [file](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        std::string piece(std::min<std::size_t>(length, 1 << 20), '\0');
        file->seekg(static_cast<std::streamoff>(offset));
        file->read(piece.data(), static_cast<std::streamsize>(piece.size()));
        return sink.write(piece.data(), static_cast<std::size_t>(file->gcount()));
      });
}

}  // namespace

class ViewServer::Running {
 public:
  explicit Running(Parts parts) : parts_(std::move(parts)), guard_(bound_port()) {
    set_up();
    add_pages();
    add_requests();
    thread_ = std::thread([this] { http_.listen_after_bind(); });
  }

  ~Running() {
    ends_ = true;
    http_.stop();
    thread_.join();
  }

  std::string address() const { return guard_.address(); }

 private:
  using Answer = void (Running::*)(const Request&, Response&);

  int bound_port() {
    http_.set_socket_options(set_socket_options);
    const int wanted = parts_.arguments.port;
    const int port = wanted == 0                               ? http_.bind_to_any_port("127.0.0.1")
                     : http_.bind_to_port("127.0.0.1", wanted) ? wanted
                                                               : -1;
    if (port > 0) return port;
    throw Error(ErrorCode::bad_argument,
                wanted == 0 ? "no port of the loopback interface is free"
                            : "--port: " + std::to_string(wanted) +
                                  " is in use or not permitted; leave --port out for a free one");
  }

  void set_up() {
    http_.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    http_.set_tcp_nodelay(true);
    http_.set_keep_alive_max_count(1);  // an idle connection would delay the end by seconds
    http_.set_payload_max_length(kMostBody);
    http_.set_default_headers(kHeaders);
    http_.set_pre_routing_handler([this](const Request& request, Response& response) {
      const std::string_view why = guard_.refusal(
          {request.path, request.get_header_value("Host"), request.get_header_value("Origin"),
           request.get_header_value("Sec-Fetch-Site"), request.get_header_value("Sec-Fetch-Dest")});
      if (!why.empty())
        refuse(response, 403, why);
      else if (request.has_header("Content-Encoding"))  // the limit is that of what is received
        refuse(response, 415, "the body of the request: expected it without compression");
      else
        return httplib::Server::HandlerResponse::Unhandled;
      return httplib::Server::HandlerResponse::Handled;
    });
    http_.set_error_handler([](const Request&, Response& response) {
      if (response.body.empty()) refuse(response, response.status, status_text(response.status));
    });
  }

  /// Errors of the library are answered as JSON.
  httplib::Server::Handler safely(Answer answer) {
    return [this, answer](const Request& request, Response& response) {
      try {
        (this->*answer)(request, response);
      } catch (const Error& error) {
        refuse(response, 400, error_text(error));
      } catch (const std::exception& error) {
        refuse(response, 500, error.what());
      }
    };
  }

  void add_pages() {
    const std::string& base = guard_.base();
    http_.Get(base, [this](const Request&, Response& response) {
      response.set_content(parts_.page, "text/html; charset=utf-8");
    });
    http_.Get(base + "volume", [this](const Request&, Response& response) {
      response.set_content(parts_.description, "application/json");
    });
    http_.Get(base + R"(slices/(\d)/(\d{1,9}))", safely(&Running::send_slice));
    http_.Get(base + R"(meshes/(\d{1,18}))", safely(&Running::send_mesh));
    http_.Get(base + R"(files/(\d{1,18}))", safely(&Running::send_saved));
    http_.Get(base + "events", safely(&Running::send_events));
  }

  void add_requests() {
    const std::string& base = guard_.base();
    http_.Post(base + "mesh", safely(&Running::make_mesh));
    http_.Post(base + "save", safely(&Running::save));
    http_.Post(base + "cancel", safely(&Running::cancel));
    http_.Post(base + "command", safely(&Running::send_command));
  }

  void send_slice(const Request& request, Response& response) {
    response.set_content(
        slice_samples(parts_.file.volume, whole(request.matches[1]), whole(request.matches[2])),
        kBinary);
  }

  void send_mesh(const Request& request, Response& response) {
    const MeshMaker::Bytes bytes = parts_.meshes.mesh(whole(request.matches[1]));
    if (!bytes) return refuse(response, 404, "this mesh is not kept any more");
    response.set_content_provider(
        bytes->size(), kBinary,
        [bytes](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
          return sink.write(bytes->data() + offset, length);
        });
  }

  void send_saved(const Request& request, Response& response) {
    const auto saved = parts_.saver.file(whole(request.matches[1]));
    if (!saved) return refuse(response, 404, "this file is not kept any more; save it again");
    send_file(response, *saved);
  }

  void send_events(const Request& request, Response& response) {
    if (request.method == "HEAD") return;  // not a page
    if (parts_.events.open_pages() >= kMostPages)
      return refuse(response, 503, "too many pages of this volume are open; close one");
    // The browser sends it when it connects again.
    const std::string last = request.get_header_value("Last-Event-ID");
    const auto next = std::make_shared<Events::Number>(
        last.empty() ? parts_.events.open() : parts_.events.open(whole(last)));
    response.set_chunked_content_provider(
        "text/event-stream",
        [this, next](std::size_t, httplib::DataSink& sink) {
          if (ends_) return false;
          std::string messages = parts_.events.wait(*next, kHeartbeat);
          // Without messages a comment finds out whether the page is still there.
          if (messages.empty()) messages = ":\n\n";
          return sink.write(messages.data(), messages.size());
        },
        [this](bool) { parts_.events.close(); });
  }

  void make_mesh(const Request& request, Response& response) {
    const Json body = body_of(request);
    const std::int64_t number = request_number(body);
    const PageOptions options = options_of(body);
    ExtractArguments arguments =
        parse_extract(extract_words(parts_.arguments, options, mesh_name(parts_.arguments, "ply")));
    arguments.volume.read.region = region_of(options, parts_.file.volume.view.grid.size);
    parts_.meshes.make(number, std::move(arguments));
    answer(response, Json::object());
  }

  void save(const Request& request, Response& response) {
    const Json body = body_of(request);
    const std::vector<std::string> words = checked_words(body);
    parts_.saver.save(request_number(body), words);
    answer(response, Json::object());
  }

  void cancel(const Request& request, Response& response) {
    const std::int64_t number = request_number(body_of(request));
    parts_.meshes.cancel(number);
    parts_.saver.cancel(number);
    answer(response, Json::object());
  }

  void send_command(const Request& request, Response& response) {
    answer(response, {{"command", command_text(checked_words(body_of(request)))}});
  }

  /// The words of the command that saves a mesh. Mistakes in them are an answer to the page.
  std::vector<std::string> checked_words(const Json& body) const {
    const PageOptions options = options_of(body);
    region_of(options, parts_.file.volume.view.grid.size);
    std::vector<std::string> words =
        extract_words(parts_.arguments, options, mesh_name(parts_.arguments, format_of(body)));
    parse_extract(words);
    return words;
  }

  Parts parts_;
  httplib::Server http_;
  Guard guard_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

ViewServer::ViewServer(Parts parts) : running_(std::make_unique<Running>(std::move(parts))) {}
ViewServer::~ViewServer() = default;

std::string ViewServer::address() const { return running_->address(); }

}  // namespace isoatlas::detail::tool
