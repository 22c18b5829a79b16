# libFuzzer programs for the readers, each with the address and undefined-behaviour sanitizers. scripts/fuzz.sh
# builds and runs them. Only what reads is compiled in, with its assertions.
if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  message(FATAL_ERROR "HAPTIC_CLOTH_FUZZ needs clang++ (scripts/fuzz.sh sets it)")
endif()
file(GLOB fuzzed_sources CONFIGURE_DEPENDS src/fabric/*.cpp)
add_library(fuzz_readers STATIC EXCLUDE_FROM_ALL
  ${fuzzed_sources} src/scene/option.cpp src/scene/scene_loader.cpp src/scene/scene_options.cpp src/shape/shapes.cpp
  src/scene/scene_validation.cpp src/state/number_text.cpp test/fuzz/readers.cpp)
set(fuzz_sanitizers address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer -UNDEBUG -O1 -g1)
target_compile_options(fuzz_readers PUBLIC -fsanitize=fuzzer-no-link,${fuzz_sanitizers})
target_include_directories(fuzz_readers PUBLIC include src test)
target_compile_definitions(fuzz_readers PRIVATE
  HAPTIC_CLOTH_SOURCE_FABRICS="${PROJECT_SOURCE_DIR}/config/fabrics")
target_link_libraries(fuzz_readers PUBLIC Eigen3::Eigen yaml-cpp)
foreach(reader Scene Fabric Override)
  string(TOLOWER fuzz_${reader} program)
  add_executable(${program} EXCLUDE_FROM_ALL test/fuzz/fuzzer.cpp)
  target_compile_definitions(${program} PRIVATE HAPTIC_CLOTH_FUZZED=read${reader}Bytes)
  target_link_libraries(${program} fuzz_readers -fsanitize=fuzzer,address,undefined)
  list(APPEND fuzz_programs ${program})
endforeach()
add_custom_target(fuzzers DEPENDS ${fuzz_programs})
