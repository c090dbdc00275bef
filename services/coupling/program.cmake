tact_program(tact-coupling LIBEXEC main.cpp)
target_link_libraries(tact-coupling PRIVATE tact_coupling_link tact_coupling_loop tact_service tact_session tact_log
  tact_rt_alloc_hooks)
