# Instruction sets of the kernels. Files src/*/*_kernels.cpp are compiled once for each set, in a namespace of its own.
# Which set runs is chosen at start (src/simd/path.cpp), so the same build runs on every machine.

# haptic_cloth_kernel_path(NAME LANES FLAGS...): an instruction set, added to kernel_paths.
set(kernel_paths)
macro(haptic_cloth_kernel_path name lanes)
  list(APPEND kernel_paths ${name})
  set(kernel_lanes_${name} ${lanes})
  set(kernel_flags_${name} -ffp-contract=fast ${ARGN})
endmacro()

if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|i[3-6]86)$")
  set(HAPTIC_CLOTH_X86 1)
  haptic_cloth_kernel_path(sse2 2 -msse2)
  haptic_cloth_kernel_path(avx2 4 -mavx2 -mfma)
  haptic_cloth_kernel_path(avx512 8 -mavx2 -mfma -mavx512f -mavx512vl -mavx512dq -mavx512bw
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)  # gcc 12's own avx512fintrin.h
else()
  set(HAPTIC_CLOTH_X86 0)
  haptic_cloth_kernel_path(baseline 2)
endif()
