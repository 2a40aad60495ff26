// SPDX-License-Identifier: Apache-2.0
#include "io/library_messages.h"

#include <itkObject.h>
#include <vtkLogger.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

#include <iostream>
#include <regex>
#include <string_view>

#include "io/file_error.h"

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
  bool itk_warnings = itk::Object::GetGlobalWarningDisplay();
  vtkLogger::Verbosity vtk_verbosity = vtkLogger::GetCurrentVerbosityCutoff();
  std::ostringstream sink;  // MetaIO and GDCM write to std::cerr and std::cout
  std::streambuf* cerr_buffer = std::cerr.rdbuf();
  std::streambuf* cout_buffer = std::cout.rdbuf();
};

LibraryMessages::LibraryMessages() : lock_(library_mutex()), windows_(std::make_unique<Windows>()) {
  vtkOutputWindow::SetInstance(windows_->collecting);
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);  // VTK reports twice: to the window and to its log
  itk::Object::SetGlobalWarningDisplay(false);
  std::cerr.rdbuf(windows_->sink.rdbuf());
  std::cout.rdbuf(windows_->sink.rdbuf());
}

LibraryMessages::~LibraryMessages() {
  std::cout.rdbuf(windows_->cout_buffer);
  std::cerr.rdbuf(windows_->cerr_buffer);
  itk::Object::SetGlobalWarningDisplay(windows_->itk_warnings);
  vtkLogger::SetStderrVerbosity(windows_->vtk_verbosity);
  vtkOutputWindow::SetInstance(windows_->vtk_window);
}

std::string LibraryMessages::first_vtk_error() const { return short_message(windows_->collecting->first_error); }

std::string short_message(const std::string& text) {
  // Teem (NRRD) tells a story, one line for each function on the way; the last line is the cause.
  const std::size_t last_teem_line = text.rfind("[nrrd] ");
  const std::string cause = last_teem_line == std::string::npos ? text : text.substr(last_teem_line);
  // "itk::ERROR: NrrdImageIO(0x55d0): Read: ..." and "ERROR: In file.cxx, line 12\nvtkXMLDataParser (0x55d0): ..."
  static const std::regex noise(
      R"(itk::ERROR:|ITK ERROR:|ERROR: In \S+ line \d+|Reason: Success|[A-Za-z:]+ ?\(0x[0-9a-f]+\):|\[nrrd\]|_?(nrrd|airh?)\w+:)");
  return one_line(std::regex_replace(cause, noise, " "));
}

}  // namespace isoatlas::io
