# isoatlas_flags(TARGET) sets the flags for warnings, floating-point arithmetic and sanitizers.
option(ISOATLAS_WARNINGS_AS_ERRORS "treat warnings as errors" ${ISOATLAS_IS_TOP_LEVEL})
set(ISOATLAS_SANITIZE "" CACHE STRING "sanitizers to build with, e.g. address,undefined or thread")

function(isoatlas_flags target)
  # No contraction and no fast-math: results have the same bytes at each optimisation level.
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
    -Wno-sign-conversion -ffp-contract=off $<$<BOOL:${ISOATLAS_WARNINGS_AS_ERRORS}>:-Werror>)
  if(ISOATLAS_SANITIZE)
    target_compile_options(${target} PUBLIC -fsanitize=${ISOATLAS_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${ISOATLAS_SANITIZE})
  endif()
endfunction()
