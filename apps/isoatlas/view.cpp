// SPDX-License-Identifier: Apache-2.0
// isoatlas view: a page on which the isovalue is chosen by looking.
#include <stdlib.h>
#include <unistd.h>

#include <chrono>
#include <iostream>
#include <string>
#include <system_error>
#include <thread>

#include "commands.h"
#include "exit_status.h"
#include "isoatlas/error.h"
#include "page/page.h"
#include "view/browser.h"
#include "view/events.h"
#include "view/mesh_maker.h"
#include "view/messages.h"
#include "view/saver.h"
#include "view/server.h"
#include "view/viewed_volume.h"
#include "volume_input.h"

namespace isoatlas::detail::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kPoll{50};
/// A page that is loaded again is closed for a moment.
constexpr std::chrono::seconds kPatience{4};

/// A folder that only this user can read, deleted at the end.
class PrivateFolder {
 public:
  PrivateFolder() {
    std::error_code error;
    fs::path parent = fs::temp_directory_path(error);
    if (error) {
      const char* wanted = std::getenv("TMPDIR");
      parent = wanted != nullptr ? wanted : "/tmp";
    }
    std::string name = (parent / "isoatlas-view-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw Error(ErrorCode::bad_file, parent.string() +
                                           ": no folder for temporary files can be made here; set "
                                           "TMPDIR to a folder that can be written");
    path_ = name;
  }
  ~PrivateFolder() { remove(); }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  const fs::path& path() const { return path_; }
  void remove() noexcept {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }

 private:
  fs::path path_;
};

}  // namespace

int run_view(const ViewArguments& arguments, Interruption& interruption) {
  require_pages();
  const VolumeFile file = read_volume_input(arguments.volume.path, arguments.volume.read);
  print_warnings(std::cerr, arguments.volume.path, file.source);
  const std::string description = describe_for_page(arguments, file);

  PrivateFolder folder;
  Events events;
  Saver saver(folder.path(), events);
  const Interruption::Cleanup clean_up(interruption, [&] {
    saver.stop();
    folder.remove();
  });
  MeshMaker meshes(file.volume.view, events);
  const ViewServer server({arguments, file, view_html(), description, events, meshes, saver});
  std::cout << server.address() << std::endl;
  const bool is_opened =
      arguments.opens_browser && open_in_browser(server.address(), folder.path());
  if (!arguments.quiet)
    std::cerr << (is_opened ? "If no browser shows it, open this address in one. "
                            : "Open this address in a browser. ")
              << "isoatlas view ends when its page is closed, or with Ctrl-C." << std::endl;

  while (!interruption.requested() && !events.all_closed_for(kPatience))
    std::this_thread::sleep_for(kPoll);
  interruption.finish();  // ending is what Ctrl-C is for here
  events.send(goodbye("isoatlas view has ended"));
  std::this_thread::sleep_for(kPoll);  // for the message to be sent
  saver.end();
  folder.remove();
  // The server is not ended: it would wait for its connections, and any program of this computer
  // can keep one open for as long as it likes.
  std::cout.flush();
  _exit(kSuccess);
}

}  // namespace isoatlas::detail::tool
