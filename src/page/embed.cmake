# cmake -D OUT=assets.cpp -P embed.cmake [SCRIPT STYLE]
# Writes a source file with these texts, or with empty ones.
set(script "")
set(style "")
if(CMAKE_ARGC GREATER 6)
  file(READ ${CMAKE_ARGV5} script)
  file(READ ${CMAKE_ARGV6} style)
endif()
foreach(text IN ITEMS script style)
  string(FIND "${${text}}" ")isoatlas\"" at)
  if(NOT at EQUAL -1)
    message(FATAL_ERROR
      "the page's ${text} contains )isoatlas\", which would end its string literal")
  endif()
endforeach()
file(WRITE ${OUT} "#include \"page/assets.h\"\n
namespace isoatlas::detail::page {
std::string_view script() { return R\"isoatlas(${script})isoatlas\"; }
std::string_view style() { return R\"isoatlas(${style})isoatlas\"; }
}  // namespace isoatlas::detail::page
")
