// SPDX-License-Identifier: Apache-2.0
#include "files/library_messages.h"

#include <vtkLogger.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

#include <iostream>
#include <string_view>

#include "files/file_error.h"

namespace isoatlas::io {

namespace {

std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}

class CollectingWindow : public vtkOutputWindow {
 public:
  static CollectingWindow* New() { VTK_STANDARD_NEW_BODY(CollectingWindow); }
  vtkTypeMacro(CollectingWindow, vtkOutputWindow)

      void DisplayErrorText(const char* text) override {
    // The pipeline repeats every failure with a dump of its request, which tells nobody anything.
    if (first_error.empty() && std::string_view(text).find("returned failure for request") == std::string_view::npos) {
      first_error = text;
    }
  }
  void DisplayText(const char*) override {}
  void DisplayWarningText(const char*) override {}
  void DisplayGenericWarningText(const char*) override {}
  void DisplayDebugText(const char*) override {}

  std::string first_error;
};

}  // namespace

struct LibraryMessages::Windows {
  vtkSmartPointer<CollectingWindow> collecting = vtkSmartPointer<CollectingWindow>::New();
  vtkSmartPointer<vtkOutputWindow> vtk_window = vtkOutputWindow::GetInstance();
  vtkLogger::Verbosity vtk_verbosity = vtkLogger::GetCurrentVerbosityCutoff();
  std::ostringstream sink;  // decoders write to std::cerr and std::cout
  std::streambuf* cerr_buffer = std::cerr.rdbuf();
  std::streambuf* cout_buffer = std::cout.rdbuf();
};

LibraryMessages::LibraryMessages() : lock_(library_mutex()), windows_(std::make_unique<Windows>()) {
  vtkOutputWindow::SetInstance(windows_->collecting);
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);  // VTK reports twice: to the window and to its log
  std::cerr.rdbuf(windows_->sink.rdbuf());
  std::cout.rdbuf(windows_->sink.rdbuf());
}

LibraryMessages::~LibraryMessages() {
  std::cout.rdbuf(windows_->cout_buffer);
  std::cerr.rdbuf(windows_->cerr_buffer);
  vtkLogger::SetStderrVerbosity(windows_->vtk_verbosity);
  vtkOutputWindow::SetInstance(windows_->vtk_window);
}

std::string LibraryMessages::first_vtk_error() const { return short_message(windows_->collecting->first_error); }

std::string short_message(const std::string& text) {
  std::string_view cause = text;
  // "ITK ERROR: NrrdImageIO(0x55d0): ..." and "ERROR: In file.cxx, line 12\nvtkXMLDataParser (0x55d0): ..."
  if (const std::size_t address = cause.find("(0x"); address != std::string_view::npos) {
    const std::size_t end = cause.find("): ", address);
    cause.remove_prefix(end == std::string_view::npos ? 0 : end + 3);
  }
  // Teem (NRRD) tells a story, one line "[nrrd] function: ..." for each function on the way; the last is the cause.
  constexpr std::string_view kTeem = "[nrrd] ";
  if (const std::size_t line = cause.rfind(kTeem); line != std::string_view::npos) {
    cause.remove_prefix(line + kTeem.size());
    const std::size_t function_end = cause.find(": ");
    cause.remove_prefix(function_end == std::string_view::npos ? 0 : function_end + 2);
  }
  for (const std::string_view prefix : {"itk::ERROR: ", "ITK ERROR: "}) {
    cause.remove_prefix(cause.starts_with(prefix) ? prefix.size() : 0);
  }
  const std::string line = one_line(cause);
  return line.substr(0, line.find(" Reason: Success"));
}

}  // namespace isoatlas::io
