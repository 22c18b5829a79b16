# Parts as unit tests; the nodes under rostest, which starts a master of its own on a free port.
find_package(rostest REQUIRED)
find_package(roslaunch REQUIRED)
roslaunch_add_file_check(launch)

# test/ros/ROOM/NAME.test starts nodes around NAME_test.cpp; other files *_test.cpp are unit tests.
file(GLOB unit_sources CONFIGURE_DEPENDS test/ros/*/*_test.cpp)
file(GLOB launches CONFIGURE_DEPENDS test/ros/*/*.test)
add_library(ros_test_support STATIC EXCLUDE_FROM_ALL test/ros/support/ros_test_support.cpp
  test/ros/faults/fault_support.cpp test/ros/faults/raw_listeners.cpp)
haptic_cloth_test_settings(ros_test_support)
target_link_libraries(ros_test_support test_support)
set(ros_test_programs ros_unit_tests)
foreach(launch ${launches})
  string(REGEX REPLACE "\\.test$" "_test.cpp" source "${launch}")
  list(REMOVE_ITEM unit_sources "${source}")
  get_filename_component(name "${launch}" NAME_WE)
  file(RELATIVE_PATH launch "${PROJECT_SOURCE_DIR}" "${launch}")
  add_rostest_gtest(ros_${name}_test ${launch} ${source})
  haptic_cloth_test_settings(ros_${name}_test)
  target_link_libraries(ros_${name}_test ros_test_support)
  list(APPEND ros_test_programs ros_${name}_test)
endforeach()
haptic_cloth_test(ros_unit_tests ${unit_sources})
target_link_libraries(ros_unit_tests test_support)

add_test(NAME bench_latency_smoke COMMAND "${PROJECT_SOURCE_DIR}/bench/latency" --smoke
  --build "${PROJECT_BINARY_DIR}" --out "${PROJECT_BINARY_DIR}/bench_latency")

# A file system that does not answer, for one of the tests.
add_library(slow_disk MODULE EXCLUDE_FROM_ALL test/ros/node/slow_disk.cpp)
target_link_libraries(slow_disk ${CMAKE_DL_LIBS})
target_compile_definitions(ros_lifecycle_test PRIVATE HAPTIC_CLOTH_SLOW_DISK="$<TARGET_FILE:slow_disk>")
add_dependencies(ros_lifecycle_test slow_disk)

foreach(name ros_test_support ${ros_test_programs})
  target_include_directories(${name} SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
  target_link_libraries(${name} haptic_cloth_ros)
  add_dependencies(${name} ${${PROJECT_NAME}_EXPORTED_TARGETS} haptic_cloth_node haptic_cloth_nodelet hand mouse_hand
    path_hand monitor device_adapter grasp_button latency_probe simulate)
endforeach()
