# The configure step ends with what is on, what is off, and why.

function(describe_switch name is_on why_on why_off)
  if(is_on)
    message(STATUS "  on   ${name}: ${why_on}")
  else()
    message(STATUS "  off  ${name}: ${why_off}")
  endif()
endfunction()

set(recordings ${PROJECT_SOURCE_DIR}/../shared/data)
if(DEFINED ENV{APRILTRACK_SHARED})
  set(recordings $ENV{APRILTRACK_SHARED}/data)
endif()
get_filename_component(recordings ${recordings} ABSOLUTE)
set(recordings_found FALSE)
if(IS_DIRECTORY ${recordings})
  set(recordings_found TRUE)
endif()

message(STATUS "")
message(STATUS "apriltrack ${PROJECT_VERSION}, ${CMAKE_BUILD_TYPE}, ${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}")
message(STATUS "  with Eigen ${Eigen3_VERSION}, apriltag ${apriltag_VERSION}, Ceres ${Ceres_VERSION}, OpenCV ${OpenCV_VERSION}, "
               "yaml-cpp ${yaml-cpp_VERSION}, fmt ${fmt_VERSION}")
describe_switch("tests" "${APRILTRACK_BUILD_TESTS}"
  "APRILTRACK_BUILD_TESTS; run them with ctest or scripts/test" "APRILTRACK_BUILD_TESTS=OFF")
describe_switch("recordings in tests" "${recordings_found}"
  "in ${recordings}" "no folder ${recordings}; tests that need one skip and say so")
describe_switch("examples" "${APRILTRACK_BUILD_EXAMPLES}"
  "APRILTRACK_BUILD_EXAMPLES" "APRILTRACK_BUILD_EXAMPLES=OFF")
describe_switch("benchmarks" "${APRILTRACK_BUILD_BENCHMARKS}"
  "APRILTRACK_BUILD_BENCHMARKS" "APRILTRACK_BUILD_BENCHMARKS=OFF")
describe_switch("warnings as errors" "${APRILTRACK_WERROR}"
  "APRILTRACK_WERROR, our own code only" "APRILTRACK_WERROR=OFF")
describe_switch("sanitizers" "${APRILTRACK_SANITIZE}"
  "APRILTRACK_SANITIZE=${APRILTRACK_SANITIZE}" "APRILTRACK_SANITIZE is empty")
describe_switch("coverage" "${APRILTRACK_COVERAGE}" "APRILTRACK_COVERAGE, gcov" "APRILTRACK_COVERAGE=OFF")
describe_switch("ccache" "${APRILTRACK_CCACHE}" "${APRILTRACK_CCACHE}" "not installed; rebuilds take longer")
message(STATUS "  install to ${CMAKE_INSTALL_PREFIX}: components ${known_components}")
message(STATUS "")
