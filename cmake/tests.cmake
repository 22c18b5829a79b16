# One gtest program a folder, the examples, the rules on the sources and, with ROS, the node tests.
enable_testing()
find_package(GTest QUIET)
if(NOT GTEST_FOUND AND NOT GTest_FOUND)
  message(FATAL_ERROR "gtest not found (libgtest-dev): the tests would be skipped silently")
endif()

# haptic_cloth_test(NAME SOURCES...): a gtest program and its ctest entry.
function(haptic_cloth_test name)
  if(catkin_FOUND)
    catkin_add_gtest(${name} test/gtest_main.cpp ${ARGN})
    if(NOT TARGET ${name})
      message(FATAL_ERROR "gtest not found: tests would be skipped silently")
    endif()
  else()
    add_executable(${name} test/gtest_main.cpp ${ARGN})
    target_link_libraries(${name} GTest::GTest)
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${HAPTIC_CLOTH_PROGRAM_DIR}")
    add_test(NAME ${name}
      COMMAND ${name} --gtest_output=xml:${HAPTIC_CLOTH_RESULTS_DIR}/gtest-${name}.xml)
  endif()
  # Several files a compilation, which halves the time; so each file has a namespace of its name.
  set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 6)
  haptic_cloth_test_settings(${name})
endfunction()

function(haptic_cloth_test_settings name)
  target_include_directories(${name} PRIVATE test)
  target_compile_definitions(${name} PRIVATE HAPTIC_CLOTH_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} haptic_cloth_tools Threads::Threads)
endfunction()

# Compiled once for all programs that use it.
file(GLOB support_sources CONFIGURE_DEPENDS test/support/*.cpp)
list(REMOVE_ITEM support_sources "${PROJECT_SOURCE_DIR}/test/support/exact_geometry.cpp")
add_library(test_support STATIC EXCLUDE_FROM_ALL ${support_sources})
haptic_cloth_test_settings(test_support)

# Alone, because CGAL brings compiler flags.
find_package(CGAL REQUIRED QUIET)
add_library(exact_geometry STATIC EXCLUDE_FROM_ALL test/support/exact_geometry.cpp)
target_include_directories(exact_geometry PRIVATE test)
target_link_libraries(exact_geometry PRIVATE haptic_cloth_private CGAL::CGAL)

foreach(folder unit physics stability fuzz)
  file(GLOB sources CONFIGURE_DEPENDS test/${folder}/*.cpp test/${folder}/*/*.cpp)
  list(REMOVE_ITEM sources "${PROJECT_SOURCE_DIR}/test/fuzz/fuzzer.cpp" "${PROJECT_SOURCE_DIR}/test/fuzz/race.cpp")
  if(sources)
    haptic_cloth_test(${folder}_tests ${sources})
    if(NOT folder STREQUAL "fuzz")
      target_link_libraries(${folder}_tests test_support)
    endif()
  endif()
endforeach()
if(HAPTIC_CLOTH_SANITIZE STREQUAL "thread")  # of the unit tests those with threads, for scripts/sanitize.sh
  haptic_cloth_test(exchange_tests
    test/unit/haptics/exchange_test.cpp test/unit/haptics/haptics_test.cpp test/support/scenes.cpp)
endif()
target_compile_definitions(unit_tests PRIVATE HAPTIC_CLOTH_SIMULATE="$<TARGET_FILE:simulate>"
  HAPTIC_CLOTH_KES_TEST="$<TARGET_FILE:kes_test>")
target_link_libraries(unit_tests exact_geometry)
add_dependencies(unit_tests simulate kes_test)

# Every path of the kernels: all unit tests, and of the others those that go through each kernel (stretch, bending,
# shear, twist, contact, preconditioner, changes of the mesh) or depend on rounding (solves that are cut short). Paths
# that the machine lacks are reported as skipped, and so is its best, which everything takes without --path.
set(short_unit "*")
set(short_physics "Determinism.*:*InPlane.*:*HeavyStrip.*:*WoolStrip.Lowered*:*Blade.LosesIts*:*Trellis*:OnBox.*")
set(short_physics "${short_physics}:*OnSlope.*:*PressedMembrane.*:*Pinch.Holds*:MeshChange.RestSurvivesRoundTrips")
set(short_physics "${short_physics}:*LateSolver*")
set(short_stability "ClothLoop.IsQuietAndFirm:Torture.CrumpledIntoACorner:*TortureStiffness.*")
set(short_stability "${short_stability}:Torture.EverythingChangesInEveryStep:Torture.SavedSceneReplaysTheSameBits")
foreach(path ${kernel_paths})
  foreach(folder unit physics stability)
    add_test(NAME ${folder}_tests_${path} COMMAND ${folder}_tests --path=${path}
      "--gtest_filter=SimdPath.*:${short_${folder}}"
      --gtest_output=xml:${HAPTIC_CLOTH_RESULTS_DIR}/gtest-${folder}_tests_${path}.xml)
    set_tests_properties(${folder}_tests_${path} PROPERTIES SKIP_RETURN_CODE 77)
  endforeach()
endforeach()

add_test(NAME bench_z_width_smoke COMMAND "${PROJECT_SOURCE_DIR}/bench/z_width"
  --tests $<TARGET_FILE:stability_tests> --out "${PROJECT_BINARY_DIR}/bench_z_width")

# A minute of libFuzzer in all, for the three readers side by side, from one seed, so that it fails where a change
# broke something and not by chance. Its replay, in fuzz_tests, needs no clang.
find_program(HAPTIC_CLOTH_CLANG NAMES clang++ clang++-19 clang++-16 clang++-15 clang++-14 clang++-10)
if(HAPTIC_CLOTH_CLANG)
  add_test(NAME fuzz_readers COMMAND "${PROJECT_SOURCE_DIR}/scripts/fuzz.sh" --seconds 20 --seed 1
    --build "${PROJECT_BINARY_DIR}/fuzz")
else()
  message(WARNING "clang++ not found: the readers are not fuzzed, their seeds are replayed only")
endif()

add_test(NAME hello_cloth COMMAND hello_cloth)
add_test(NAME haptic_loop COMMAND haptic_loop --seconds 1)

# What find_package(haptic_cloth) gives. A sanitized library is for this build alone. The folder is
# hidden, so that roslaunch does not find the launch files installed in it beside the package's own.
if(NOT HAPTIC_CLOTH_SANITIZE)
  add_test(NAME consumer COMMAND ${CMAKE_COMMAND} "-DSOURCE=${PROJECT_SOURCE_DIR}"
    "-DBUILD=${PROJECT_BINARY_DIR}" "-DWORK=${PROJECT_BINARY_DIR}/.consumer"
    "-DCOMPILER=${CMAKE_CXX_COMPILER}" "-DCATKIN=${catkin_FOUND}"
    -P "${PROJECT_SOURCE_DIR}/test/consumer/check.cmake")
endif()

# The README's C++ is compiled and run as it stands there.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/README.md")
file(READ "${PROJECT_SOURCE_DIR}/README.md" readme)
string(REGEX MATCH "```cpp\n([^`]*)```" snippet "${readme}")
file(WRITE "${PROJECT_BINARY_DIR}/readme_example.txt" "${CMAKE_MATCH_1}")
configure_file("${PROJECT_BINARY_DIR}/readme_example.txt" "${PROJECT_BINARY_DIR}/readme_example.cpp" COPYONLY)
add_executable(readme_example "${PROJECT_BINARY_DIR}/readme_example.cpp")
target_link_libraries(readme_example haptic_cloth)
add_test(NAME readme_example COMMAND readme_example WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
set_tests_properties(readme_example PROPERTIES PASS_REGULAR_EXPRESSION "force on the probe: [0-9]+\\.[0-9]+ N")

# The benchmarks' scripts on tiny meshes: they run and their results are well formed. Nothing is said of time.
foreach(bench chart resolution grids coarse_start time_order table1 peers_table layers savings force_error realtime active_limit
    threads scaling)
  set(scratch "${PROJECT_BINARY_DIR}/bench_${bench}")
  add_test(NAME bench_${bench}_smoke COMMAND "${PROJECT_SOURCE_DIR}/bench/${bench}" --smoke
    --simulate $<TARGET_FILE:simulate> --cache "${scratch}" --out "${scratch}")
endforeach()
if(TARGET kernel_times)
  add_test(NAME bench_kernels_smoke COMMAND "${PROJECT_SOURCE_DIR}/bench/kernels" --smoke
    --program $<TARGET_FILE:kernel_times> --out "${PROJECT_BINARY_DIR}/bench_kernels")
endif()
add_test(NAME bench_pages COMMAND "${PROJECT_SOURCE_DIR}/bench/pages" --check)
add_test(NAME bench_compare COMMAND "${PROJECT_SOURCE_DIR}/bench/compare_test.py")

# Counts do not depend on the machine's load, but they do on how it is built.
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  add_test(NAME bench_instructions COMMAND "${PROJECT_SOURCE_DIR}/bench/instructions"
    --simulate $<TARGET_FILE:simulate> --out "${PROJECT_BINARY_DIR}/bench_instructions")
  set_tests_properties(bench_instructions PROPERTIES SKIP_RETURN_CODE 77)
endif()

if(catkin_FOUND)
  include(cmake/ros_tests.cmake)
  # catkin leaves tests out of 'all'; a plain ctest after a plain build must find them.
  add_custom_target(test_binaries ALL)
  add_dependencies(test_binaries tests)
endif()

get_property(all_tests DIRECTORY PROPERTY TESTS)
# Half an hour is for slow and busy machines; the longest takes five minutes on a core of 2022.
set_tests_properties(${all_tests} PROPERTIES TIMEOUT 1800
  ENVIRONMENT "PATH=/usr/bin:/bin:$ENV{PATH};ROS_HOSTNAME=localhost;OMP_WAIT_POLICY=passive")
# Tests of the node run alone: their programs use all cores.
foreach(test ${all_tests})
  if(test MATCHES "rostest|roslaunch|bench_latency|consumer")
    set_tests_properties(${test} PROPERTIES RUN_SERIAL TRUE)
  endif()
endforeach()
