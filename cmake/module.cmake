# Of a module all of whose files lie in rooms, a unity build compiles each room as one file: a new file in one room changes no other's, and names
# in anonymous namespaces need to differ within a room alone.
function(apriltrack_group_by_rooms target source_dir)
  file(GLOB beside_rooms ${source_dir}/*.cpp)
  if(beside_rooms)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  foreach(source IN LISTS ARGN)
    get_filename_component(folder ${source} DIRECTORY)
    get_filename_component(room ${folder} NAME)
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${room})
  endforeach()
endfunction()

# One folder = one target. The list of DEPENDS is the list of lower floors that the module may include;
# docs/architecture.md holds the table and scripts/check_layers holds the #include lines against it.
#
#   apriltrack_add_module(camera DEPENDS geometry image io PRIVATE_LIBRARIES yaml-cpp)
#
# builds libtrack/src/camera/*.cpp into libapriltrack_camera.a, known as apriltrack::camera. Folders in it are rooms of the module:
# their files belong to it as well.
function(apriltrack_add_module name)
  cmake_parse_arguments(ARG "" "SOURCE_DIR;INCLUDE_DIR" "DEPENDS;PRIVATE_LIBRARIES" ${ARGN})
  if(NOT ARG_SOURCE_DIR)
    set(ARG_SOURCE_DIR ${PROJECT_SOURCE_DIR}/libtrack/src/${name})
    set(ARG_INCLUDE_DIR ${PROJECT_SOURCE_DIR}/libtrack/include)
  endif()
  set(target apriltrack_${name})
  file(GLOB sources CONFIGURE_DEPENDS ${ARG_SOURCE_DIR}/*.cpp ${ARG_SOURCE_DIR}/*/*.cpp)
  if(sources)
    set(scope PUBLIC)
    add_library(${target} STATIC ${sources})
    apriltrack_group_by_rooms(${target} ${ARG_SOURCE_DIR} ${sources})
    apriltrack_compile_options(${target})
    target_link_libraries(${target} PRIVATE ${ARG_PRIVATE_LIBRARIES})
  else()
    set(scope INTERFACE)
    add_library(${target} INTERFACE)
  endif()
  add_library(apriltrack::${name} ALIAS ${target})
  target_compile_features(${target} ${scope} cxx_std_20)
  target_include_directories(${target} ${scope}
    $<BUILD_INTERFACE:${ARG_INCLUDE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} ${scope} Eigen3::Eigen)
  foreach(dependency IN LISTS ARG_DEPENDS)
    target_link_libraries(${target} ${scope} apriltrack_${dependency})
  endforeach()
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  set_property(GLOBAL APPEND PROPERTY APRILTRACK_MODULES ${target})
endfunction()

# What is under test is built as users run it; its tests themselves quickly. (GCC 12 at -O3 sees ghosts in std::string, too.)
function(apriltrack_test_options target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# One test program per folder of tests/: tests/<name>/*_test.cpp -> test_<name>, run by ctest in PARTS processes. A process
# for each test would make anew the scene that many share, and start two thousand times. One test alone:
# bin/test_camera --gtest_filter=Camera.Undistorts.
#
#   apriltrack_add_tests(camera LIBRARIES apriltrack::camera [LABELS threaded] [PARTS 2])
function(apriltrack_add_tests name)
  cmake_parse_arguments(ARG "" "PARTS" "LIBRARIES;LABELS;DEFINITIONS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(test_${name} ${sources})
  apriltrack_compile_options(test_${name})
  target_compile_definitions(test_${name} PRIVATE ${ARG_DEFINITIONS})
  apriltrack_test_options(test_${name})
  target_precompile_headers(test_${name} REUSE_FROM apriltrack_test_support)
  target_link_libraries(test_${name} PRIVATE ${ARG_LIBRARIES} apriltrack_test_support)
  set_property(GLOBAL APPEND PROPERTY APRILTRACK_UNIT_TESTS test_${name})
  if("threaded" IN_LIST ARG_LABELS)
    set_property(GLOBAL APPEND PROPERTY APRILTRACK_THREADED_TESTS test_${name})
  endif()
  apriltrack_add_test_parts(${name} "${ARG_PARTS}" "${ARG_LABELS};${name}")
endfunction()

# GoogleTest deals its tests out itself; a part without any fails, for then a filter came in from outside. The largest programs
# start first.
function(apriltrack_add_test_parts name num_parts labels)
  if(NOT num_parts)
    set(num_parts 1)
  endif()
  foreach(part RANGE 1 ${num_parts})
    math(EXPR index "${part} - 1")
    add_test(NAME ${name}/${part} COMMAND test_${name})
    set_tests_properties(${name}/${part} PROPERTIES LABELS "${labels}" TIMEOUT 3600 COST ${num_parts}
      FAIL_REGULAR_EXPRESSION "Running 0 tests from"
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${num_parts};GTEST_SHARD_INDEX=${index}")
  endforeach()
endfunction()
