# Conversions as unit tests; the nodes under rostest, which starts a master of its own on a free port.
find_package(rostest REQUIRED)
find_package(roslaunch REQUIRED)
roslaunch_add_file_check(launch)

file(GLOB sources CONFIGURE_DEPENDS test/ros/unit/*.cpp)
haptic_cloth_test(ros_unit_tests ${sources})
set(ros_test_programs ros_unit_tests)

foreach(name node fingers admittance lifecycle playback hand nodelet device live)
  add_rostest_gtest(ros_${name}_test test/ros/${name}.test test/ros/${name}_test.cpp test/ros/ros_test_support.cpp)
  haptic_cloth_test_settings(ros_${name}_test)
  list(APPEND ros_test_programs ros_${name}_test)
endforeach()

add_test(NAME bench_latency_smoke COMMAND "${PROJECT_SOURCE_DIR}/bench/latency" --smoke
  --build "${PROJECT_BINARY_DIR}" --out "${PROJECT_BINARY_DIR}/bench_latency")

# A file system that does not answer, for one of the tests.
add_library(slow_disk MODULE EXCLUDE_FROM_ALL test/ros/slow_disk.cpp)
target_link_libraries(slow_disk ${CMAKE_DL_LIBS})
target_compile_definitions(ros_lifecycle_test PRIVATE HAPTIC_CLOTH_SLOW_DISK="$<TARGET_FILE:slow_disk>")
add_dependencies(ros_lifecycle_test slow_disk)

# What a node has to endure.
foreach(name pose clock listener process)
  add_rostest_gtest(ros_${name}_faults_test test/ros/${name}_faults.test test/ros/${name}_faults_test.cpp
    test/ros/fault_support.cpp test/ros/raw_listeners.cpp test/ros/ros_test_support.cpp)
  haptic_cloth_test_settings(ros_${name}_faults_test)
  list(APPEND ros_test_programs ros_${name}_faults_test)
endforeach()

foreach(name ${ros_test_programs})
  target_include_directories(${name} SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
  target_link_libraries(${name} haptic_cloth_ros)
  add_dependencies(${name} ${${PROJECT_NAME}_EXPORTED_TARGETS} haptic_cloth_node haptic_cloth_nodelet hand mouse_hand
    path_hand monitor device_adapter)
endforeach()
