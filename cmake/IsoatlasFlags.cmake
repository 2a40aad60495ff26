# isoatlas_flags(TARGET) sets the flags for warnings, floating-point arithmetic and sanitizers.
option(ISOATLAS_WARNINGS_AS_ERRORS "treat warnings as errors" ${ISOATLAS_IS_TOP_LEVEL})
set(ISOATLAS_SANITIZE "" CACHE STRING "sanitizers to build with, e.g. address,undefined or thread")

option(ISOATLAS_UNITY_BUILD
  "compile a module's source files together: half the time for all, but a change costs its module"
  OFF)

function(isoatlas_flags target)
  # No contraction and no fast-math: results have the same bytes at each optimisation level.
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
    -Wno-sign-conversion -ffp-contract=off $<$<BOOL:${ISOATLAS_WARNINGS_AS_ERRORS}>:-Werror>)
  # GCC 12 warns of std::string's own concatenation (its bug 105651).
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
  if(ISOATLAS_SANITIZE)
    target_compile_options(${target} PUBLIC -fsanitize=${ISOATLAS_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${ISOATLAS_SANITIZE})
  endif()
endfunction()

# Of a target whose source files may be compiled together: their anonymous namespaces have no name
# in common.
function(isoatlas_allow_unity target)
  set_target_properties(${target} PROPERTIES
    UNITY_BUILD ${ISOATLAS_UNITY_BUILD} UNITY_BUILD_BATCH_SIZE 0)
endfunction()

# Of a target that is as fast, measured, at a lower level of optimisation, which compiles sooner:
# with -Og the modules for files and the tool in three quarters of the time that -O1 takes.
function(isoatlas_optimize_at level target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:${level}>)
endfunction()
