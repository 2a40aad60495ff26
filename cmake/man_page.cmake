# Writes the help page of a command, or of the tool if COMMAND is empty, as a manual page. Keeps the
# line breaks.
#   cmake -D TOOL=isoatlas -D COMMAND=extract -D VERSION=0.1.0 -D OUT=isoatlas-extract.1
#     -P man_page.cmake
execute_process(COMMAND ${TOOL} help ${COMMAND} OUTPUT_VARIABLE page COMMAND_ERROR_IS_FATAL ANY)
set(name isoatlas)
if(COMMAND)
  set(name isoatlas-${COMMAND})
endif()

string(REPLACE "\\" "\\e" page "${page}")
string(REPLACE "-" "\\-" page "${page}")
string(REGEX REPLACE "\n    ([.'])" "\n    \\\\&\\1" page "\n${page}")
# `whatis` reads the line below NAME: "isoatlas\-extract \- ...".
string(REPLACE "-" " " typed "${COMMAND}")
string(REPLACE "-" "\\-" in_name "${COMMAND}")
if(COMMAND)
  string(REPLACE "\nNAME\n    isoatlas ${typed} " "\nNAME\n    isoatlas\\-${in_name} "
    page "${page}")
endif()
string(REGEX REPLACE "\nNAME\n    ([^\n]*)\n" "\n.SH NAME\n\\1\n" page "${page}")
string(REGEX REPLACE "\n+([A-Z][A-Z ]+)\n" "\n.fi\n.SH \\1\n.nf\n" page "${page}")
string(REGEX REPLACE "\n    " "\n" page "${page}")
string(TOUPPER ${name} title)
file(WRITE ${OUT} ".TH ${title} 1 \"\" \"isoatlas ${VERSION}\" \"isoatlas manual\"${page}")
