# Every third-party library, found once. Why each is here stands in CONTRIBUTING.md.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(nanoflann REQUIRED)
find_package(TBB REQUIRED)
find_package(Ceres REQUIRED)
find_package(CGAL REQUIRED)
find_package(CLI11 REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(pugixml REQUIRED)
find_package(ZLIB REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)

# CGAL is header-only; its target adds -frounding-math to whoever links it, which is right only for the files that
# use it. Those name the flag themselves and their floor links DENDROFIT_CGAL_LIBRARIES.
set(DENDROFIT_CGAL_LIBRARIES gmp mpfr)

# Embree 3 (Debian 12) and 4 (Ubuntu 24.04) are told apart in the sources by __has_include.
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_package(embree 3 REQUIRED)
endif()

# PCL's own ${PCL_LIBRARIES} drags VTK and Qt onto every command line; only these are needed, by name. (Not segmentation
# and filters: with what they need they take 45 ms to load, in every command.)
find_path(DENDROFIT_PCL_INCLUDE pcl/point_cloud.h PATH_SUFFIXES pcl-1.15 pcl-1.14 pcl-1.13 pcl-1.12 REQUIRED)
add_library(dendrofit_pcl INTERFACE)
target_include_directories(dendrofit_pcl SYSTEM INTERFACE ${DENDROFIT_PCL_INCLUDE})
foreach(name sample_consensus common)
  find_library(DENDROFIT_PCL_${name} pcl_${name} REQUIRED)
  target_link_libraries(dendrofit_pcl INTERFACE ${DENDROFIT_PCL_${name}})
endforeach()
target_link_libraries(dendrofit_pcl INTERFACE Eigen3::Eigen)
install(TARGETS dendrofit_pcl EXPORT dendrofitTargets)

# Of OpenCV only imgproc and core, by name: its CMake package asks for every module to be installed.
find_path(DENDROFIT_OPENCV_INCLUDE opencv2/imgproc.hpp PATH_SUFFIXES opencv4 REQUIRED)
add_library(dendrofit_opencv INTERFACE)
target_include_directories(dendrofit_opencv SYSTEM INTERFACE ${DENDROFIT_OPENCV_INCLUDE})
foreach(name imgproc core)
  find_library(DENDROFIT_OPENCV_${name} opencv_${name} REQUIRED)
  target_link_libraries(dendrofit_opencv INTERFACE ${DENDROFIT_OPENCV_${name}})
endforeach()
install(TARGETS dendrofit_opencv EXPORT dendrofitTargets)
