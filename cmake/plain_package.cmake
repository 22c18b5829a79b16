# Without ROS: plain CMake with the same places for what is built.
message(STATUS "haptic_cloth: without ROS")
option(HAPTIC_CLOTH_TESTS "Build the tests" ON)
option(BUILD_SHARED_LIBS "Build a shared library" ON)
set(HAPTIC_CLOTH_PROGRAM_DIR "${PROJECT_BINARY_DIR}/devel/lib/haptic_cloth")
set(HAPTIC_CLOTH_LIBRARY_DIR "${PROJECT_BINARY_DIR}/devel/lib")
set(HAPTIC_CLOTH_RESULTS_DIR "${PROJECT_BINARY_DIR}/test_results/haptic_cloth")
