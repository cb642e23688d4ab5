# `cmake --install` gives headers <apriltrack/...>, one static library per module, find_package(apriltrack COMPONENTS
# ...) and a pkg-config file per component, and one of all of them. tests/install builds an outside project against the installed tree.
#
# A component is what a user asks for; each brings the outside libraries of its own and no others:
#   track   localise and track: no OpenCV, no Ceres         calib   build tag maps (Ceres)
#   source  read images, videos (OpenCV, FFmpeg, libjpeg) and bags (LZ4, zstd, bzip2, SQLite)
#   eval, sim  scoring, rendering                           export  maps for viewers and simulators
#   report  draw pictures, videos and pages (OpenCV, FFmpeg)
#   inspect  what is wrong with recordings before they are used to calibrate (brings calib, source and eval)
#
# CMake's own install components are the packages: development (headers, libraries) and tools (program, pages, documents, maps).

include(CMakePackageConfigHelpers)

set(components track calib source eval sim report export inspect)
set(modules_of_track base geometry image io camera tags detect motion filter photometric tracker)
foreach(component calib source eval sim report export inspect)
  set(modules_of_${component} ${component})
endforeach()
set(modules_of_source bag source)

# Outside libraries without a pkg-config file of their own, or whose own names far more than is used (opencv4).
set(pc_requires_of_track "eigen3 fmt yaml-cpp apriltag libhwy")
set(pc_requires_of_source "libavformat libavcodec libswscale libavutil libjpeg liblz4 libzstd sqlite3")
set(pc_requires_of_inspect "apriltrack-calib apriltrack-source apriltrack-eval")
set(pc_requires_of_report "libavformat libavcodec libswscale libavutil")
set(pc_libraries_of_calib "-lceres -lglog")
set(pc_libraries_of_source "-lopencv_videoio -lopencv_imgcodecs -lopencv_imgproc -lopencv_core -lbz2")
set(pc_libraries_of_report "-lopencv_imgcodecs -lopencv_imgproc -lopencv_core")

set(config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/apriltrack)
set(pkgconfig_folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
set(generated_folder ${PROJECT_BINARY_DIR}/install)

# The prefix as seen from the .pc file, so that the installed tree may be moved.
file(RELATIVE_PATH pc_prefix /prefix/${pkgconfig_folder} /prefix)
string(REGEX REPLACE "/$" "" pc_prefix "${pc_prefix}")

add_library(apriltrack_track INTERFACE)
add_library(apriltrack::track ALIAS apriltrack_track)
set_target_properties(apriltrack_track PROPERTIES EXPORT_NAME track)
foreach(module IN LISTS modules_of_track)
  target_link_libraries(apriltrack_track INTERFACE apriltrack_${module})
endforeach()
install(TARGETS apriltrack_track EXPORT apriltrack-track)

get_property(all_modules GLOBAL PROPERTY APRILTRACK_MODULES)
set(unassigned ${all_modules})
foreach(component IN LISTS components)
  set(pc_own_libraries "")
  foreach(module IN LISTS modules_of_${component})
    list(REMOVE_ITEM unassigned apriltrack_${module})
    install(TARGETS apriltrack_${module} EXPORT apriltrack-${component} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
      COMPONENT development)
    get_target_property(type apriltrack_${module} TYPE)
    if(NOT type STREQUAL "INTERFACE_LIBRARY")
      # Static libraries are searched once, from left to right: upper floors come first.
      string(PREPEND pc_own_libraries "-lapriltrack_${module} ")
    endif()
  endforeach()
  install(EXPORT apriltrack-${component} NAMESPACE apriltrack:: DESTINATION ${config_folder}
    FILE apriltrack-${component}-targets.cmake COMPONENT development)
  set(pc_component ${component})
  set(pc_requires "${pc_requires_of_${component}}")
  if(NOT component STREQUAL "track")
    string(PREPEND pc_requires "apriltrack-track ")
  endif()
  set(pc_libraries "${pc_own_libraries}${pc_libraries_of_${component}}")
  configure_file(${PROJECT_SOURCE_DIR}/cmake/apriltrack.pc.in ${generated_folder}/apriltrack-${component}.pc @ONLY)
  install(FILES ${generated_folder}/apriltrack-${component}.pc DESTINATION ${pkgconfig_folder} COMPONENT development)
endforeach()
set(pc_all_components inspect calib export report eval sim source track)  # users of others before those
list(TRANSFORM pc_all_components PREPEND apriltrack-)
list(JOIN pc_all_components " " pc_all_components)
configure_file(${PROJECT_SOURCE_DIR}/cmake/apriltrack-all.pc.in ${generated_folder}/apriltrack.pc @ONLY)
install(FILES ${generated_folder}/apriltrack.pc DESTINATION ${pkgconfig_folder} COMPONENT development)
if(unassigned)
  message(FATAL_ERROR "cmake/install.cmake: no component installs ${unassigned}")
endif()

list(JOIN components " " known_components)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/apriltrackConfig.cmake.in
  ${generated_folder}/apriltrackConfig.cmake INSTALL_DESTINATION ${config_folder})
# Before 1.0 every minor version may change the interface.
write_basic_package_version_file(${generated_folder}/apriltrackConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${generated_folder}/apriltrackConfig.cmake ${generated_folder}/apriltrackConfigVersion.cmake
  DESTINATION ${config_folder} COMPONENT development)

install(DIRECTORY libtrack/include/apriltrack calib/include/apriltrack DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  COMPONENT development FILES_MATCHING PATTERN "*.h")

install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools PATTERN "decisions" EXCLUDE)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools)
install(DIRECTORY maps DESTINATION ${CMAKE_INSTALL_DATADIR}/apriltrack COMPONENT tools)
include(cmake/manual.cmake)
