tact_program(tact-view LIBEXEC main.cpp)
target_link_libraries(tact-view PRIVATE tact_view_feed tact_view_control tact_service tact_session tact_log tact_fault tact_file)

# The page is data: found beside the program in the build tree as in the installed one.
file(GLOB _tact_page CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/page/*")
set(_tact_page_copies "")
foreach(file IN LISTS _tact_page)
  get_filename_component(name "${file}" NAME)
  add_custom_command(OUTPUT "${TACT_SHARE_DIR}/page/${name}" DEPENDS "${file}"
                     COMMAND "${CMAKE_COMMAND}" -E copy "${file}" "${TACT_SHARE_DIR}/page/${name}" VERBATIM)
  list(APPEND _tact_page_copies "${TACT_SHARE_DIR}/page/${name}")
endforeach()
add_custom_target(tact_view_page ALL DEPENDS ${_tact_page_copies})
add_dependencies(tact-view tact_view_page)
install(FILES ${_tact_page} DESTINATION "${CMAKE_INSTALL_DATADIR}/tact/page")
