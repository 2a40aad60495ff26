# isoatlas_module(NAME SOURCES a.cpp ... DEPENDS core ... [LINK lib ...])
#
# One static library target per folder of src/. DEPENDS is the architecture: scripts/check_layers.py compares it with
# every #include, so a module can only use what it declares. Tests, the tool and the Python module link these targets;
# users of the library link what isoatlas_library() makes of them.
function(isoatlas_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;LINK" ${ARGN})
  set(target isoatlas_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target}
    PUBLIC ${PROJECT_SOURCE_DIR}/include ${PROJECT_BINARY_DIR}/include
    PUBLIC ${PROJECT_SOURCE_DIR}/src)
  foreach(dependency IN LISTS ARG_DEPENDS)
    target_link_libraries(${target} PUBLIC isoatlas_${dependency})
  endforeach()
  target_link_libraries(${target} PRIVATE ${ARG_LINK})
  set_target_properties(${target} PROPERTIES
    POSITION_INDEPENDENT_CODE ON CXX_EXTENSIONS OFF CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  isoatlas_flags(${target})
  isoatlas_allow_unity(${target})
endfunction()

# isoatlas_library(NAME SHARED|STATIC OUTPUT name MODULES core ... LINK lib ...)
#
# A library for users: the object files of the modules in one file, with the public headers alone on the include path.
# A shared one exports only what a public header marks ISOATLAS_API.
function(isoatlas_library target kind)
  cmake_parse_arguments(ARG "" "OUTPUT" "MODULES;LINK" ${ARGN})
  list(TRANSFORM ARG_MODULES REPLACE "(.+)" "$<TARGET_OBJECTS:isoatlas_\\1>" OUTPUT_VARIABLE objects)
  add_library(${target} ${kind} ${objects})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${ARG_OUTPUT} LINKER_LANGUAGE CXX
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} INTERFACE
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} PRIVATE ${ARG_LINK})
  if(kind STREQUAL SHARED)
    target_link_options(${target} PRIVATE -Wl,--exclude-libs,ALL -Wl,--as-needed)
  endif()
endfunction()
