# Manual pages and completions, which the program writes itself, and where a system looks for them.

if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
  message(STATUS "No manual pages and completions: the program that writes them does not run here (CMAKE_CROSSCOMPILING_EMULATOR)")
  return()
endif()

set(manual_folder ${PROJECT_BINARY_DIR}/manual)
set(completion_files "")
foreach(shell IN ITEMS bash zsh fish)
  set(file ${manual_folder}/completion.${shell})
  add_custom_command(OUTPUT ${file} DEPENDS apriltrack_app VERBATIM
    COMMAND ${CMAKE_COMMAND} -E make_directory ${manual_folder}
    COMMAND apriltrack_app completion ${shell} > ${file})
  list(APPEND completion_files ${file})
endforeach()
add_custom_command(OUTPUT ${manual_folder}/man1/apriltrack.1 DEPENDS apriltrack_app VERBATIM
  COMMAND ${CMAKE_COMMAND} -E remove_directory ${manual_folder}/man1  # pages of commands that are gone
  COMMAND ${CMAKE_COMMAND} -E make_directory ${manual_folder}/man1
  COMMAND apriltrack_app help --man-folder ${manual_folder}/man1)
add_custom_target(apriltrack_manual ALL DEPENDS ${completion_files} ${manual_folder}/man1/apriltrack.1)

install(DIRECTORY ${manual_folder}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT tools)
install(FILES ${manual_folder}/completion.bash RENAME apriltrack
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT tools)
install(FILES ${manual_folder}/completion.zsh RENAME _apriltrack
  DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT tools)
install(FILES ${manual_folder}/completion.fish RENAME apriltrack.fish
  DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT tools)
