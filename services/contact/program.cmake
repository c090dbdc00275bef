tact_program(tact-contact LIBEXEC main.cpp)
target_link_libraries(tact-contact PRIVATE tact_contact_server tact_contact_pipeline tact_service tact_session tact_log
  tact_rt tact_fault)
