# `cpack -G DEB` in the build folder makes isoatlas_VERSION_ARCH.deb with the tool, its manual pages
# and completions, the libraries, headers, and files for CMake and pkg-config.
# scripts/make_package.sh builds it.
set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL runtime libraries development)  # the Python module has wheels
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGE_NAME isoatlas)
set(CPACK_PACKAGE_CONTACT "The isoatlas authors <isoatlas@isoatlas.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY
  "adaptive triangle meshes of isosurfaces, with certified topology")
set(CPACK_PACKAGE_DESCRIPTION
"Turns scalar volumes (CT, MRI, microscopy, simulations, distance fields) into
adaptive, multiresolution triangle meshes whose topology is verified. Contains
the command-line tool, the C++ library and what is needed to build with it.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# dpkg-shlibdeps finds the package's own libraries in the build folder.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/src)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libhdf5-103-1")  # loaded to read HDF5 files
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libtbb-dev, libgmp-dev")
include(CPack)
