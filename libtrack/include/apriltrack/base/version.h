#pragma once

// The version of these headers; CMakeLists.txt reads it here. A test holds those of recipes against it.

#if !defined(_MSVC_LANG) && __cplusplus < 202002L
#error \
    "AprilTrack needs C++20: compile with -std=c++20, or link the CMake target apriltrack::track, which asks for it."
#endif

#define APRILTRACK_VERSION_MAJOR 0
#define APRILTRACK_VERSION_MINOR 2
#define APRILTRACK_VERSION_PATCH 0

/// To be compared by the preprocessor: 0.2.0 is 200, and 1.2.3 is 10203.
#define APRILTRACK_VERSION_NUMBER \
  (APRILTRACK_VERSION_MAJOR * 10000 + APRILTRACK_VERSION_MINOR * 100 + APRILTRACK_VERSION_PATCH)

namespace apriltrack {

/// "0.2.0": of the library that the program is linked with. Before 1.0 a new minor version may change the
/// interface; a patch version changes neither source nor binary interface (scripts/check_abi).
const char* version();

}  // namespace apriltrack
