# Rules of `cmake --install` and CPack. Components: runtime (the tool), libraries, development,
# python.
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/isoatlas)

# install_library(COMPONENT TARGET ...): installs the targets and exports them for
# find_package(isoatlas COMPONENTS ...).
function(install_library name)
  install(TARGETS ${ARGN} EXPORT isoatlas_${name}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libraries NAMELINK_COMPONENT development
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  install(EXPORT isoatlas_${name} NAMESPACE isoatlas:: FILE isoatlas-${name}-targets.cmake
    DESTINATION ${package_folder} COMPONENT development)
endfunction()

set(io_headers block_file.h io.h json.h mesh_file.h neuroglancer.h text_file.h volume_file.h
  volume_reader.h volume_source.h)
file(GLOB headers RELATIVE ${PROJECT_SOURCE_DIR}/include/isoatlas
  ${PROJECT_SOURCE_DIR}/include/isoatlas/*.h)
set(vtk_headers vtkIsoAtlas.h)
list(REMOVE_ITEM headers ${io_headers} ${vtk_headers})

function(install_headers)
  list(TRANSFORM ARGN PREPEND ${PROJECT_SOURCE_DIR}/include/isoatlas/ OUTPUT_VARIABLE files)
  install(FILES ${files} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/isoatlas COMPONENT development)
endfunction()

file(RELATIVE_PATH pc_to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)

function(install_pkgconfig name)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endfunction()

install_library(core isoatlas_shared isoatlas_static)
install_headers(${headers})
install(FILES ${PROJECT_BINARY_DIR}/include/isoatlas/version.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/isoatlas COMPONENT development)
install_pkgconfig(isoatlas)
if(ISOATLAS_BUILD_IO)
  install_library(io isoatlas_io_shared)
  install_headers(${io_headers})
  install_pkgconfig(isoatlas_io)
endif()

if(ISOATLAS_BUILD_VTK_FILTER)
  install_library(vtk isoatlas_vtk)
  install_headers(${vtk_headers})
endif()

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/isoatlas-config.cmake.in
  ${PROJECT_BINARY_DIR}/isoatlas-config.cmake
  INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/isoatlas-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(
  FILES ${PROJECT_BINARY_DIR}/isoatlas-config.cmake
    ${PROJECT_BINARY_DIR}/isoatlas-config-version.cmake
  DESTINATION ${package_folder} COMPONENT development)

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE
  DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT runtime)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/samples/
  DESTINATION ${CMAKE_INSTALL_DATADIR}/isoatlas/samples COMPONENT runtime)

include(IsoatlasPackage)
