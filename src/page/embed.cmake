# cmake -D OUT=assets.cpp -P embed.cmake [FOLDER]
# Writes a source file with the scripts and style sheets of FOLDER, or with empty texts.
set(functions "")
foreach(asset IN ITEMS script=page.js style=page.css view_script=view.js view_style=view.css)
  string(REGEX MATCH "^(.*)=(.*)$" matched ${asset})
  set(name ${CMAKE_MATCH_1})
  set(text "")
  if(CMAKE_ARGC GREATER 5)
    file(READ ${CMAKE_ARGV5}/${CMAKE_MATCH_2} text)
  endif()
  string(FIND "${text}" ")isoatlas\"" at)
  if(NOT at EQUAL -1)
    message(FATAL_ERROR
      "${CMAKE_MATCH_2} contains )isoatlas\", which would end its string literal")
  endif()
  string(APPEND functions "std::string_view ${name}() { return R\"isoatlas(${text})isoatlas\"; }\n")
endforeach()
file(WRITE ${OUT} "#include \"page/assets.h\"\n
namespace isoatlas::detail::page {
${functions}}  // namespace isoatlas::detail::page
")
