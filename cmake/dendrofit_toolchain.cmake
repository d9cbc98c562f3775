# Language level, warnings, sanitizers and the compiler cache, once for every target.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})

find_program(DENDROFIT_CCACHE ccache)
if(DENDROFIT_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Relative to the checkout, so that several checkouts (and CI's fresh clones) share the cache.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=true
      ${DENDROFIT_CCACHE})
endif()

add_library(dendrofit_flags INTERFACE)
add_library(dendrofit::flags ALIAS dendrofit_flags)
set_target_properties(dendrofit_flags PROPERTIES EXPORT_NAME flags)
target_compile_features(dendrofit_flags INTERFACE cxx_std_20)
# Debian's PCL is built for SSE2: without these two, Eigen's aligned allocator disagrees with it.
target_compile_definitions(dendrofit_flags INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1 EIGEN_MAX_ALIGN_BYTES=16)
# Identical bytes everywhere: no fused multiply-add where the source does not ask for one.
target_compile_options(dendrofit_flags INTERFACE -ffp-contract=off)
install(TARGETS dendrofit_flags EXPORT dendrofitTargets)

set(DENDROFIT_PRIVATE_OPTIONS -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 sees overlapping copies in every "text" + std::string (its bug 105651).
  list(APPEND DENDROFIT_PRIVATE_OPTIONS -Wno-restrict)
endif()
if(DENDROFIT_WERROR)
  # GCC 12 suspects members of empty std::optional values that are never read.
  list(APPEND DENDROFIT_PRIVATE_OPTIONS -Werror -Wno-error=maybe-uninitialized)
endif()
if(DENDROFIT_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()
if(DENDROFIT_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()
