# One folder = one target. The list of DEPENDS is the list of lower floors that the module may include;
# docs/architecture.md holds the table and scripts/check_layers holds the #include lines against it.
#
#   apriltrack_add_module(camera DEPENDS geometry image io PRIVATE_LIBRARIES yaml-cpp)
#
# builds libtrack/src/camera/*.cpp into libapriltrack_camera.a, known as apriltrack::camera.
function(apriltrack_add_module name)
  cmake_parse_arguments(ARG "" "SOURCE_DIR;INCLUDE_DIR" "DEPENDS;PRIVATE_LIBRARIES" ${ARGN})
  if(NOT ARG_SOURCE_DIR)
    set(ARG_SOURCE_DIR ${PROJECT_SOURCE_DIR}/libtrack/src/${name})
    set(ARG_INCLUDE_DIR ${PROJECT_SOURCE_DIR}/libtrack/include)
  endif()
  set(target apriltrack_${name})
  file(GLOB sources CONFIGURE_DEPENDS ${ARG_SOURCE_DIR}/*.cpp)
  if(sources)
    set(scope PUBLIC)
    add_library(${target} STATIC ${sources})
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

# One test program per folder of tests/: tests/<name>/*_test.cpp -> test_<name>.
#
#   apriltrack_add_tests(camera LIBRARIES apriltrack::camera [LABELS threaded])
function(apriltrack_add_tests name)
  cmake_parse_arguments(ARG "" "" "LIBRARIES;LABELS;DEFINITIONS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(test_${name} ${sources})
  apriltrack_compile_options(test_${name})
  target_compile_definitions(test_${name} PRIVATE ${ARG_DEFINITIONS})
  target_link_libraries(test_${name} PRIVATE ${ARG_LIBRARIES} apriltrack_test_support)
  gtest_discover_tests(test_${name} DISCOVERY_MODE PRE_TEST TEST_PREFIX "${name}/"
    PROPERTIES LABELS "${ARG_LABELS};${name}" TIMEOUT 600)
endfunction()
