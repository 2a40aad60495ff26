# Installs the tool with its manual pages and completion scripts, which the tool prints itself.
set(printed ${CMAKE_CURRENT_BINARY_DIR}/printed)
file(MAKE_DIRECTORY ${printed})
set(files)
set(pages)
foreach(command IN ITEMS "" blocks-merge blocks-plan blocks-run check completion extract info levels
    picture report view)
  set(page ${printed}/isoatlas.1)
  if(command)
    set(page ${printed}/isoatlas-${command}.1)
  endif()
  add_custom_command(OUTPUT ${page}
    COMMAND ${CMAKE_COMMAND} -D TOOL=$<TARGET_FILE:isoatlas_tool> -D COMMAND=${command}
      -D VERSION=${PROJECT_VERSION} -D OUT=${page}
      -P ${PROJECT_SOURCE_DIR}/cmake/man_page.cmake
    DEPENDS isoatlas_tool ${PROJECT_SOURCE_DIR}/cmake/man_page.cmake VERBATIM)
  list(APPEND pages ${page})
endforeach()
# install_completion(shell name folder)
function(install_completion shell name folder)
  set(script ${printed}/${shell}/${name})
  add_custom_command(OUTPUT ${script}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${printed}/${shell}
    COMMAND isoatlas_tool completion ${shell} > ${script} DEPENDS isoatlas_tool VERBATIM)
  install(FILES ${script} DESTINATION ${CMAKE_INSTALL_DATADIR}/${folder} COMPONENT runtime)
  set(files ${files} ${script} PARENT_SCOPE)
endfunction()
install_completion(bash isoatlas bash-completion/completions)
install_completion(zsh _isoatlas zsh/vendor-completions)
install_completion(fish isoatlas.fish fish/vendor_completions.d)
add_custom_target(isoatlas_printed ALL DEPENDS ${pages} ${files})

install(TARGETS isoatlas_tool RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)

set(module_folder ${CMAKE_INSTALL_LIBDIR}/isoatlas/slicer)
file(RELATIVE_PATH tool_from_module /${module_folder} /${CMAKE_INSTALL_BINDIR}/isoatlas)
isoatlas_slicer_module(${CMAKE_CURRENT_BINARY_DIR}/slicer/IsoAtlas ${tool_from_module})
install(PROGRAMS ${CMAKE_CURRENT_BINARY_DIR}/slicer/IsoAtlas
  DESTINATION ${module_folder} COMPONENT runtime)
