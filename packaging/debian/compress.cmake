# Manual pages and changelogs of a Debian package are packed, without the time at which that was done.
file(GLOB_RECURSE files ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*/share/man/*.1 ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*/share/doc/*/changelog)
foreach(file IN LISTS files)
  execute_process(COMMAND gzip -9n ${file} RESULT_VARIABLE status)
  if(status)
    message(FATAL_ERROR "gzip ${file}: ${status}")
  endif()
endforeach()
