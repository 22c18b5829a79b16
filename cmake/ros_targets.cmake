# The ROS side: one library with everything, and a thin main for each node.
set(ros_mains node_main.cpp nodelet.cpp hand_main.cpp mouse_hand_main.cpp path_hand_main.cpp monitor_main.cpp
  device_adapter_main.cpp grasp_button_main.cpp latency_probe_main.cpp)
file(GLOB ros_sources CONFIGURE_DEPENDS src/ros/*/*.cpp)
foreach(main ${ros_mains})
  list(REMOVE_ITEM ros_sources "${PROJECT_SOURCE_DIR}/src/ros/programs/${main}")
endforeach()

add_library(haptic_cloth_ros ${ros_sources})
add_library(haptic_cloth_nodelet src/ros/programs/nodelet.cpp)
add_executable(haptic_cloth_node src/ros/programs/node_main.cpp)
add_executable(hand src/ros/programs/hand_main.cpp)
add_executable(mouse_hand src/ros/programs/mouse_hand_main.cpp)
add_executable(path_hand src/ros/programs/path_hand_main.cpp)
add_executable(monitor src/ros/programs/monitor_main.cpp)
add_executable(device_adapter src/ros/programs/device_adapter_main.cpp)
add_executable(grasp_button src/ros/programs/grasp_button_main.cpp)

haptic_cloth_headers(haptic_cloth_ros PUBLIC ros)
target_link_libraries(haptic_cloth_ros haptic_cloth haptic_cloth_haptics ${catkin_LIBRARIES})
# A thread that waits for a file system outlives an unloaded nodelet; its code must stay.
set_property(TARGET haptic_cloth_ros APPEND_STRING PROPERTY LINK_FLAGS " -Wl,-z,nodelete")
set(ros_nodes haptic_cloth_nodelet haptic_cloth_node hand mouse_hand path_hand monitor device_adapter grasp_button)
foreach(target ${ros_nodes})
  target_link_libraries(${target} haptic_cloth_ros)
endforeach()
foreach(target haptic_cloth_ros ${ros_nodes})
  target_include_directories(${target} SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
  add_dependencies(${target} ${${PROJECT_NAME}_EXPORTED_TARGETS} ${catkin_EXPORTED_TARGETS})
endforeach()

# For bench/latency.
add_executable(latency_probe src/ros/programs/latency_probe_main.cpp)
target_include_directories(latency_probe SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
target_link_libraries(latency_probe haptic_cloth_ros nlohmann_json::nlohmann_json)
add_dependencies(latency_probe ${${PROJECT_NAME}_EXPORTED_TARGETS} ${catkin_EXPORTED_TARGETS})

# The target of find_package(haptic_cloth), for packages that use the devel space.
export(TARGETS haptic_cloth NAMESPACE haptic_cloth::
  FILE "${CATKIN_DEVEL_PREFIX}/share/haptic_cloth/cmake/haptic_cloth-targets.cmake")

list(APPEND programs haptic_cloth_node hand mouse_hand path_hand monitor device_adapter grasp_button
  latency_probe)
install(TARGETS haptic_cloth_ros haptic_cloth_nodelet LIBRARY DESTINATION lib ARCHIVE DESTINATION lib)
install(FILES nodelet_plugins.xml DESTINATION share/haptic_cloth)
install(DIRECTORY launch DESTINATION share/haptic_cloth)
install(PROGRAMS scripts/demo.sh DESTINATION lib/haptic_cloth)
