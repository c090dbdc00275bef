# Libraries that Tact is compared with, for the benchmarks and the tests alone: the product never needs them.
# tact_fcl and tact_openvdb exist where the packages libfcl-dev and libopenvdb-dev are installed.
find_package(fcl CONFIG QUIET)
if(TARGET fcl)
  add_library(tact_fcl INTERFACE)
  get_target_property(_dirs fcl INTERFACE_INCLUDE_DIRECTORIES)
  target_include_directories(tact_fcl SYSTEM INTERFACE ${_dirs})
  target_link_libraries(tact_fcl INTERFACE fcl Eigen3::Eigen)
endif()

find_path(TACT_OPENVDB_INCLUDE openvdb/openvdb.h)
find_library(TACT_OPENVDB_LIBRARY openvdb)
find_library(TACT_IMATH_LIBRARY Imath)
if(TACT_OPENVDB_INCLUDE AND TACT_OPENVDB_LIBRARY AND TACT_IMATH_LIBRARY)
  add_library(tact_openvdb INTERFACE)
  target_include_directories(tact_openvdb SYSTEM INTERFACE "${TACT_OPENVDB_INCLUDE}")
  target_link_libraries(tact_openvdb INTERFACE "${TACT_OPENVDB_LIBRARY}" "${TACT_IMATH_LIBRARY}" TBB::tbb)
endif()
