# isoatlas_module(NAME SOURCES a.cpp ... DEPENDS core ... [LINK lib ...])
#
# One static library target per folder of src/. DEPENDS is the architecture: scripts/check_layers.py compares it with
# every #include, so a module can only use what it declares.
function(isoatlas_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;LINK" ${ARGN})
  set(target isoatlas_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
  foreach(dependency IN LISTS ARG_DEPENDS)
    target_link_libraries(${target} PUBLIC isoatlas_${dependency})
  endforeach()
  target_link_libraries(${target} PRIVATE ${ARG_LINK})
  isoatlas_flags(${target})
endfunction()
