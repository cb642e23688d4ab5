# Debian packages by CPack: `apriltrack` (program, pages, documents, maps) and `libapriltrack-dev` (headers, static libraries).
# scripts/release configures for them; APRILTRACK_PACKAGE adds what Debian's policy wants beside the files that all users get.

set(APRILTRACK_MAINTAINER "AprilTrack developers <maintainers@apriltrack.invalid>" CACHE STRING "Who answers for the packages")

set(package_folder ${PROJECT_BINARY_DIR}/package)
# The terms below the title and the copyright line, in the form of a Debian control file.
function(read_licence file first_word variable)
  file(READ ${file} terms)
  string(FIND "${terms}" "${first_word}" start)
  string(SUBSTRING "${terms}" ${start} -1 terms)
  string(STRIP "${terms}" terms)
  string(REPLACE "\n\n" "\n.\n" terms "${terms}")
  string(REPLACE "\n" "\n " terms "${terms}")
  set(${variable} "${terms}" PARENT_SCOPE)
endfunction()
read_licence(LICENSE Redistribution licence_terms)
read_licence(third_party/three/LICENSE Permission licence_of_three)
configure_file(packaging/debian/copyright.in ${package_folder}/copyright @ONLY)
# The newest change says when: packages of one commit are the same, byte by byte.
string(TIMESTAMP package_date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # of SOURCE_DATE_EPOCH where it is set
configure_file(packaging/debian/changelog.in ${package_folder}/changelog @ONLY)
foreach(pair IN ITEMS tools=apriltrack development=libapriltrack-dev)
  string(REPLACE "=" ";" pair ${pair})
  list(GET pair 0 component)
  list(GET pair 1 package)
  set(doc ${CMAKE_INSTALL_DATADIR}/doc/${package})
  install(FILES ${package_folder}/copyright DESTINATION ${doc} COMPONENT ${component})
  install(FILES ${package_folder}/changelog DESTINATION ${doc} COMPONENT ${component})
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME apriltrack)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT ${APRILTRACK_MAINTAINER})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL tools development)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/packaging/debian/compress.cmake)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME apriltrack)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)
set(CPACK_COMPONENT_TOOLS_DESCRIPTION
  "AprilTags give robots and cameras cheap ground truth, until something moves
fast: motion blur smears the payload and detectors see nothing. AprilTrack
builds a map of the tags from images, video or bags, tracks the camera in it by
the pixels of all visible tags, and says how sure it is.
.
This package has the command apriltrack, its manual pages and completions, the
documents and maps to print.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libapriltrack-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
# Static libraries: what they use is the program's to link.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "libeigen3-dev, libfmt-dev, libyaml-cpp-dev, libapriltag-dev, libhwy-dev, libceres-dev, libopencv-dev, libavformat-dev, libavcodec-dev, libswscale-dev, liblz4-dev, libzstd-dev, libbz2-dev, libsqlite3-dev, libjpeg-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "apriltrack (= ${PROJECT_VERSION}), cmake, pkgconf | pkg-config")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
  "AprilTags give robots and cameras cheap ground truth, until something moves
fast: motion blur smears the payload and detectors see nothing. AprilTrack
builds a map of the tags from images, video or bags, tracks the camera in it by
the pixels of all visible tags, and says how sure it is.
.
This package has the C++20 headers and static libraries, for CMake
(find_package(apriltrack)) and pkg-config.")

include(CPack)
