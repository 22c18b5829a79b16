# The kernels: src/*/*_kernels.cpp, compiled once for each instruction set, in a namespace of its own. Which set
# runs is chosen at start (src/simd/path.cpp), so the same build runs on every machine.
file(GLOB kernel_sources CONFIGURE_DEPENDS src/*/*_kernels.cpp)
list(REMOVE_ITEM library_sources ${kernel_sources})

# haptic_cloth_kernels(NAME LANES FLAGS...): objects of one instruction set, added to kernel_objects; NAME is added to
# kernel_paths.
set(kernel_objects)
set(kernel_paths)
macro(haptic_cloth_kernels name lanes)
  add_library(haptic_cloth_${name} OBJECT ${kernel_sources})
  target_link_libraries(haptic_cloth_${name} PRIVATE haptic_cloth_private Eigen3::Eigen)
  target_include_directories(haptic_cloth_${name} PRIVATE include)
  target_compile_definitions(haptic_cloth_${name} PRIVATE HAPTIC_CLOTH_PATH=${name} HAPTIC_CLOTH_LANES=${lanes})
  target_compile_options(haptic_cloth_${name} PRIVATE -ffp-contract=fast ${ARGN})
  list(APPEND kernel_paths ${name})
  list(APPEND kernel_objects $<TARGET_OBJECTS:haptic_cloth_${name}>)
endmacro()

if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|i[3-6]86)$")
  set(HAPTIC_CLOTH_X86 1)
  haptic_cloth_kernels(sse2 2 -msse2)
  haptic_cloth_kernels(avx2 4 -mavx2 -mfma)
  haptic_cloth_kernels(avx512 8 -mavx2 -mfma -mavx512f -mavx512vl -mavx512dq -mavx512bw
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)  # gcc 12's own avx512fintrin.h
else()
  set(HAPTIC_CLOTH_X86 0)
  haptic_cloth_kernels(baseline 2)
endif()
