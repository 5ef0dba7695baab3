# Finds OpenBLAS and LAPACKE, and makes the target isosyrk::lapack of them.  The build of the library
# reads this file, and so does an installed isosyrk-config.cmake.  It asks for headers and libraries
# themselves: the CMake package of OpenBLAS in Debian 13 names a library that is not there.
#
# CMAKE_PREFIX_PATH says where else to look; the variables ISOSYRK_OPENBLAS_* and ISOSYRK_LAPACKE_*
# choose a file.  ISOSYRK_LAPACK_MISSING is what was not found, empty if all was.

# Debian has builds of OpenBLAS beside one another, others have one folder for its headers.
set(_isosyrk_suffixes openblas-pthread openblas-openmp openblas-serial openblas)
find_library(ISOSYRK_OPENBLAS_LIBRARY NAMES openblas openblasp PATH_SUFFIXES ${_isosyrk_suffixes})
# A cblas.h may be of any BLAS; that of OpenBLAS lies beside its configuration.
find_path(ISOSYRK_OPENBLAS_INCLUDE_DIR openblas_config.h PATH_SUFFIXES ${_isosyrk_suffixes})
find_library(ISOSYRK_LAPACKE_LIBRARY lapacke PATH_SUFFIXES ${_isosyrk_suffixes})
find_path(ISOSYRK_LAPACKE_INCLUDE_DIR lapacke.h PATH_SUFFIXES lapacke ${_isosyrk_suffixes})
unset(_isosyrk_suffixes)
mark_as_advanced(ISOSYRK_OPENBLAS_LIBRARY ISOSYRK_OPENBLAS_INCLUDE_DIR
                 ISOSYRK_LAPACKE_LIBRARY ISOSYRK_LAPACKE_INCLUDE_DIR)

set(ISOSYRK_LAPACK_MISSING "")
if(NOT ISOSYRK_OPENBLAS_LIBRARY OR NOT ISOSYRK_OPENBLAS_INCLUDE_DIR)
  set(ISOSYRK_LAPACK_MISSING "OpenBLAS (libopenblas-dev)")
elseif(NOT ISOSYRK_LAPACKE_LIBRARY OR NOT ISOSYRK_LAPACKE_INCLUDE_DIR)
  set(ISOSYRK_LAPACK_MISSING "LAPACKE (liblapacke-dev)")
elseif(NOT TARGET isosyrk::lapack)
  add_library(isosyrk::lapack INTERFACE IMPORTED)
  set_target_properties(isosyrk::lapack PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${ISOSYRK_OPENBLAS_INCLUDE_DIR};${ISOSYRK_LAPACKE_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${ISOSYRK_LAPACKE_LIBRARY};${ISOSYRK_OPENBLAS_LIBRARY}")
endif()
