# dendrofit_floor(NAME name [SOURCES ...] [HEADERS ...] [PUBLIC targets...] [PRIVATE targets...])
# One static library per floor of the house. Headers form a file set, so that they are installed under
# include/dendrofit and each is compiled alone (target all_verify_interface_header_sets).
set(CMAKE_VERIFY_INTERFACE_HEADER_SETS ON)
function(dendrofit_floor)
  cmake_parse_arguments(F "" "NAME" "SOURCES;HEADERS;PUBLIC;PRIVATE" ${ARGN})
  add_library(dendrofit_${F_NAME} STATIC ${F_SOURCES})
  add_library(dendrofit::${F_NAME} ALIAS dendrofit_${F_NAME})
  set_target_properties(dendrofit_${F_NAME} PROPERTIES EXPORT_NAME ${F_NAME})
  target_sources(dendrofit_${F_NAME} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${F_HEADERS})
  target_link_libraries(dendrofit_${F_NAME} PUBLIC dendrofit_flags ${F_PUBLIC})
  target_compile_options(dendrofit_${F_NAME} PRIVATE ${DENDROFIT_PRIVATE_OPTIONS})
  foreach(target IN LISTS F_PRIVATE)
    # Third-party libraries stay out of our interface; static linking still needs them at the end.
    target_link_libraries(dendrofit_${F_NAME} PRIVATE ${target})
  endforeach()
  install(TARGETS dendrofit_${F_NAME} EXPORT dendrofitTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
          FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/dendrofit)
endfunction()
