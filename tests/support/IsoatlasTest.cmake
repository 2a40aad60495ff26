# isoatlas_test(NAME SOURCES a.cpp ... LABELS unit ... [LINK lib ...] [TIMEOUT seconds])
#
# One GoogleTest executable; every test case becomes a ctest test NAME.Suite.Case with the given
# labels.
include_guard(GLOBAL)
include(GoogleTest)

function(isoatlas_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LABELS;LINK" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  set(target test_${name})
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE
    isoatlas_test_support ${ARG_LINK} GTest::gtest GTest::gtest_main)
  isoatlas_flags(${target})
  # Tests are full of small literals: conversions between integer types are harmless here.
  target_compile_options(${target} PRIVATE -Wno-conversion)
  gtest_discover_tests(${target} TEST_PREFIX ${name}. DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS "${ARG_LABELS}" TIMEOUT ${ARG_TIMEOUT})
endfunction()
