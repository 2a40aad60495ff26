# isoatlas_find_vtk(COMPONENT ...): find_package(VTK), without the messages about packages that VTK
# uses.
macro(isoatlas_find_vtk)
  if(NOT CMAKE_C_COMPILER_LOADED)
    enable_language(C)  # Debian's VTK package finds HDF5 and Threads by compiling C
  endif()
  set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
  find_package(VTK 9.1 REQUIRED COMPONENTS ${ARGN})
  unset(CMAKE_MESSAGE_LOG_LEVEL)
endmacro()
