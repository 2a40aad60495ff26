# What users of the library link: isoatlas::isoatlas and, for files, isoatlas::io. In another
# project they are static unless BUILD_SHARED_LIBS is set. With ISOATLAS_INSTALL both kinds of the
# core are built.

if(ISOATLAS_INSTALL OR BUILD_SHARED_LIBS)
  isoatlas_library(isoatlas_shared SHARED OUTPUT isoatlas MODULES ${core_modules}
    LINK isoatlas_core_modules)
  set_target_properties(isoatlas_shared PROPERTIES EXPORT_NAME isoatlas)
endif()
if(ISOATLAS_INSTALL OR NOT BUILD_SHARED_LIBS)
  find_package(TBB REQUIRED)
  # All that the modules link and that is not a header alone.
  isoatlas_library(isoatlas_static STATIC OUTPUT isoatlas MODULES ${core_modules} LINK TBB::tbb gmp)
  set_target_properties(isoatlas_static PROPERTIES EXPORT_NAME static)
  add_library(isoatlas::static ALIAS isoatlas_static)
endif()
if(TARGET isoatlas_shared)
  add_library(isoatlas::isoatlas ALIAS isoatlas_shared)
else()
  add_library(isoatlas::isoatlas ALIAS isoatlas_static)
endif()

if(ISOATLAS_BUILD_IO)
  if(TARGET isoatlas_shared)
    # It contains a hidden copy of the internals that it needs, because the core's library does not
    # export them.
    isoatlas_library(isoatlas_io_shared SHARED OUTPUT isoatlas_io MODULES ${io_modules}
      LINK isoatlas_shared isoatlas_core_modules isoatlas_io_modules)
    target_link_libraries(isoatlas_io_shared INTERFACE isoatlas_shared)
    set_target_properties(isoatlas_io_shared PROPERTIES EXPORT_NAME io)
    add_library(isoatlas::io ALIAS isoatlas_io_shared)
  else()
    isoatlas_library(isoatlas_io_static STATIC OUTPUT isoatlas_io MODULES ${io_modules}
      LINK isoatlas_io_modules)
    target_link_libraries(isoatlas_io_static PUBLIC isoatlas_static)
    add_library(isoatlas::io ALIAS isoatlas_io_static)
  endif()
endif()

if(ISOATLAS_BUILD_VTK_FILTER)
  isoatlas_find_vtk(CommonCore CommonDataModel CommonExecutionModel CommonMath)
  set(kind STATIC)
  if(TARGET isoatlas_shared)
    set(kind SHARED)
  endif()
  set(vtk_modules VTK::CommonCore VTK::CommonDataModel VTK::CommonExecutionModel VTK::CommonMath)
  isoatlas_library(isoatlas_vtk ${kind} OUTPUT isoatlas_vtk MODULES vtk_filter)
  target_link_libraries(isoatlas_vtk PUBLIC isoatlas::isoatlas ${vtk_modules})
  # A program that uses only the filter does not link the core itself: the filter's library finds it
  # next to itself.
  set_target_properties(isoatlas_vtk PROPERTIES EXPORT_NAME vtk INSTALL_RPATH "$ORIGIN")
  add_library(isoatlas::vtk ALIAS isoatlas_vtk)
endif()
