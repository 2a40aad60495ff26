// SPDX-License-Identifier: Apache-2.0
// isoatlas report: writes a page that shows results.
#include <iostream>
#include <string>
#include <vector>

#include "commands.h"
#include "exit_status.h"
#include "file_kinds.h"
#include "isoatlas/error.h"
#include "isoatlas/io.h"
#include "outputs/output_files.h"
#include "page/page.h"
#include "text.h"

namespace isoatlas::detail::tool {

namespace fs = std::filesystem;

int run_report(const ReportArguments& arguments, Interruption& interruption) {
  require_pages();
  for (const fs::path& result : arguments.results)
    if (same_file(result, arguments.page))
      throw Error(ErrorCode::bad_argument,
                  arguments.page.string() + ": the page would replace a result");
  require_page_name(arguments.page);
  check_output_path(arguments.page);
  OutputFiles outputs;
  const Interruption::Cleanup clean_up(interruption, [&] { outputs.discard(); });

  std::vector<PageEntry> entries;
  for (const fs::path& result : arguments.results) {
    entries.push_back(entry_of_file(result));
    for (const fs::path& source : entries.back().sources)
      if (same_file(source, arguments.page))
        throw Error(ErrorCode::bad_argument, arguments.page.string() + ": the page would replace " +
                                                 source.string() + ", which it shows");
  }
  const std::string page = page_html(entries, arguments.page);
  outputs.write(arguments.page, [&](const fs::path& staged) { write_text_file(page, staged); });
  interruption.commit([&] { outputs.commit(); });
  if (!arguments.quiet)
    std::cout << row("wrote", arguments.page.string() + ": " + counted(entries.size(), "result") +
                                  ", " + bytes_text(static_cast<double>(page.size())));
  return kSuccess;
}

}  // namespace isoatlas::detail::tool
