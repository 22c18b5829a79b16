# With catkin: messages and the package's face to others.
find_package(catkin REQUIRED COMPONENTS
  roscpp nodelet pluginlib tf2_msgs tf2_ros topic_tools dynamic_reconfigure interactive_markers std_msgs std_srvs geometry_msgs sensor_msgs visualization_msgs diagnostic_msgs
  message_generation)

add_message_files(FILES ClothState.msg)
add_service_files(FILES SaveState.srv LoadState.srv)
generate_messages(DEPENDENCIES std_msgs)

catkin_package(
  INCLUDE_DIRS include
  LIBRARIES haptic_cloth
  CATKIN_DEPENDS roscpp nodelet pluginlib tf2_msgs tf2_ros topic_tools dynamic_reconfigure interactive_markers std_msgs std_srvs geometry_msgs sensor_msgs visualization_msgs
    diagnostic_msgs message_runtime
  DEPENDS EIGEN3
  CFG_EXTRAS haptic_cloth-extras.cmake)
set(HAPTIC_CLOTH_CONFIG_DIR share/haptic_cloth/cmake)

set(HAPTIC_CLOTH_TESTS ${CATKIN_ENABLE_TESTING})
set(HAPTIC_CLOTH_PROGRAM_DIR "${CATKIN_DEVEL_PREFIX}/lib/haptic_cloth")
set(HAPTIC_CLOTH_LIBRARY_DIR "${CATKIN_DEVEL_PREFIX}/lib")
set(HAPTIC_CLOTH_RESULTS_DIR "${CATKIN_TEST_RESULTS_DIR}/haptic_cloth")

# rosrun passes over everything below PACKAGE/build. Where that is the build folder, a link beside it leads there.
if(PROJECT_BINARY_DIR STREQUAL "${PROJECT_SOURCE_DIR}/build")
  execute_process(COMMAND ${CMAKE_COMMAND} -E create_symlink build/devel "${PROJECT_SOURCE_DIR}/devel")
endif()
