# Without ROS: plain CMake with the same places for what is built.
message(STATUS "haptic_cloth: without ROS")
option(HAPTIC_CLOTH_TESTS "Build the tests" ON)
option(BUILD_SHARED_LIBS "Build a shared library" ON)
set(HAPTIC_CLOTH_PROGRAM_DIR "${PROJECT_BINARY_DIR}/devel/lib/haptic_cloth")
set(HAPTIC_CLOTH_LIBRARY_DIR "${PROJECT_BINARY_DIR}/devel/lib")
set(HAPTIC_CLOTH_RESULTS_DIR "${PROJECT_BINARY_DIR}/test_results/haptic_cloth")

# find_package(haptic_cloth) in other projects; catkin writes these files where it is used.
include(CMakePackageConfigHelpers)
set(HAPTIC_CLOTH_CONFIG_DIR lib/cmake/haptic_cloth)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/haptic_clothConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES cmake/haptic_cloth-extras.cmake DESTINATION ${HAPTIC_CLOTH_CONFIG_DIR}
  RENAME haptic_clothConfig.cmake)
#catkin_lint: ignore_once missing_file
install(FILES "${PROJECT_BINARY_DIR}/haptic_clothConfigVersion.cmake" DESTINATION ${HAPTIC_CLOTH_CONFIG_DIR})
