# isoatlas_module(NAME SOURCES a.cpp ... DEPENDS core ... [LINK lib ...])
#
# Adds the module of a folder of src/ as a static library. DEPENDS lists the modules that it may
# include; scripts/check_layers.py compares this with every #include. Tests, the tool and the Python
# module link modules; users of the library link the targets of isoatlas_library().
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
    POSITION_INDEPENDENT_CODE ON CXX_EXTENSIONS OFF CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON)
  isoatlas_flags(${target})
  isoatlas_allow_unity(${target})
endfunction()

# isoatlas_library(NAME SHARED|STATIC OUTPUT name MODULES core ... LINK lib ...)
#
# Adds a library for users: one file with the object files of the modules; only public headers are
# on the include path. A shared library exports only the names that a public header marks
# ISOATLAS_API.
function(isoatlas_library target kind)
  cmake_parse_arguments(ARG "" "OUTPUT" "MODULES;LINK" ${ARGN})
  list(TRANSFORM ARG_MODULES REPLACE "(.+)" "$<TARGET_OBJECTS:isoatlas_\\1>"
    OUTPUT_VARIABLE objects)
  add_library(${target} ${kind} ${objects})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME ${ARG_OUTPUT} LINKER_LANGUAGE CXX
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} INTERFACE
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
    $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} PRIVATE ${ARG_LINK})
  if(kind STREQUAL SHARED)
    target_link_options(${target} PRIVATE -Wl,--exclude-libs,ALL -Wl,--as-needed)
  endif()
endfunction()
