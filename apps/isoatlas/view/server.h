// SPDX-License-Identifier: Apache-2.0
// The HTTP server of `isoatlas view`, on the loopback interface.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "arguments.h"
#include "isoatlas/volume_file.h"
#include "view/events.h"
#include "view/mesh_maker.h"
#include "view/saver.h"

namespace isoatlas::detail::tool {

/// Answers the requests of the pages. It reads no file that a request names, and writes none: saved
/// meshes are sent to the browser.
class ViewServer {
 public:
  struct Parts {
    const ViewArguments& arguments;
    const VolumeFile& file;
    std::string page;         ///< the HTML of the page
    std::string description;  ///< describe_for_page()
    Events& events;
    MeshMaker& meshes;
    Saver& saver;
  };

  /// Starts the server. @throws Error(bad_argument) if the port is not free
  explicit ViewServer(Parts parts);
  /// Ends it, with all requests.
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  /// The address of the page, with its token.
  std::string address() const;

 private:
  class Running;
  std::unique_ptr<Running> running_;
};

}  // namespace isoatlas::detail::tool
