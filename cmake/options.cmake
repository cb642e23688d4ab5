# What a user may switch, and the flags that hold for our own code only.

string(COMPARE EQUAL "${CMAKE_SOURCE_DIR}" "${PROJECT_SOURCE_DIR}" is_top_level)
option(APRILTRACK_BUILD_TESTS "Build the tests" ${is_top_level})
option(APRILTRACK_BUILD_EXAMPLES "Build the examples" ${APRILTRACK_BUILD_TESTS})
option(APRILTRACK_BUILD_BENCHMARKS "Build the benchmarks" OFF)
option(APRILTRACK_BUILD_FUZZERS "Build the fuzzers of all readers (clang++ only; preset fuzz)" OFF)
# For developers and CI alone: a user's compiler may warn of what ours does not know.
option(APRILTRACK_WERROR "Treat warnings in our own code as errors" OFF)
set(APRILTRACK_SANITIZE "" CACHE STRING "Sanitizers for our own code, as -fsanitize= takes them (address,undefined or thread)")
option(APRILTRACK_PACKAGE "Let `cpack` make Debian packages (scripts/release)" OFF)
option(APRILTRACK_COVERAGE "Instrument our own code for gcov" OFF)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Release by default: Eigen without optimisation is a hundred times slower" FORCE)
endif()

find_program(APRILTRACK_CCACHE ccache)
if(APRILTRACK_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${APRILTRACK_CCACHE})
endif()

# Warnings, sanitizers and coverage: PRIVATE, so that nothing leaks into a user's program.
function(apriltrack_compile_options target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
    -Wold-style-cast -Wfloat-conversion -Wextra-semi
    $<$<BOOL:${APRILTRACK_WERROR}>:-Werror>)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm)")
    # GCC tells there that pairs of numbers are passed in other registers than by GCC 9.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-psabi>)
  endif()
  if(APRILTRACK_SANITIZE)
    # Eigen allocates otherwise under a sanitizer than in Debian's Ceres, whose static copy the linker mixes with ours.
    target_compile_definitions(${target} PUBLIC EIGEN_MALLOC_ALREADY_ALIGNED=1)
    # Checks for null and for alignment at every access are a quarter of the time to build; where they matter, the
    # address sanitizer and Eigen's own assertions stop as well.
    target_compile_options(${target} PRIVATE -fsanitize=${APRILTRACK_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
      -fno-sanitize=null,alignment
      $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)  # GCC 12 sees ghosts inside instrumented std::function and std::regex
    target_link_options(${target} PUBLIC -fsanitize=${APRILTRACK_SANITIZE})
  endif()
  if(APRILTRACK_COVERAGE)
    target_compile_options(${target} PRIVATE --coverage)
    target_link_options(${target} PUBLIC --coverage)
  endif()
endfunction()
