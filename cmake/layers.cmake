# Layers of the library: each folder of src is a target that sees its own headers and those of the layers it links.
# "sim/cloth.h" is found only where haptic_cloth_sim is linked: the compiler refuses an include of a higher layer.
include(cmake/kernels.cmake)

# haptic_cloth_headers(TARGET SCOPE FOLDER): lets TARGET include "FOLDER/..." and nothing else of src. The include
# directory holds one link, which leads to src/FOLDER.
function(haptic_cloth_headers target scope folder)
  set(directory "${PROJECT_BINARY_DIR}/layers/${folder}")
  file(MAKE_DIRECTORY "${directory}")
  execute_process(COMMAND ${CMAKE_COMMAND} -E create_symlink "${PROJECT_SOURCE_DIR}/src/${folder}" "${directory}/${folder}"
    RESULT_VARIABLE result)
  if(result)
    message(FATAL_ERROR "cannot link ${directory}/${folder}: the build folder must allow symbolic links")
  endif()
  target_include_directories(${target} ${scope} $<BUILD_INTERFACE:${directory}>)
endfunction()

# haptic_cloth_objects(NAME LAYER SOURCES...): compiles sources of a layer for the library.
macro(haptic_cloth_objects name layer)
  add_library(${name} OBJECT ${ARGN})
  target_link_libraries(${name} PRIVATE ${layer})
  list(APPEND library_objects $<TARGET_OBJECTS:${name}>)
endmacro()

# haptic_cloth_layer(FOLDER BELOW...): the layer src/FOLDER on top of layers that were added before it. Its headers are
# the target haptic_cloth_FOLDER; its objects are added to library_objects.
set(library_objects)
macro(haptic_cloth_layer folder)
  set(layer haptic_cloth_${folder})
  add_library(${layer} INTERFACE)
  haptic_cloth_headers(${layer} INTERFACE ${folder})
  target_link_libraries(${layer} INTERFACE haptic_cloth_private)
  foreach(below ${ARGN})
    if(NOT TARGET haptic_cloth_${below})
      message(FATAL_ERROR "layer ${folder} must stand above layer ${below}")
    endif()
    target_link_libraries(${layer} INTERFACE haptic_cloth_${below})
  endforeach()

  file(GLOB sources CONFIGURE_DEPENDS src/${folder}/*.cpp)
  file(GLOB kernel_sources CONFIGURE_DEPENDS src/${folder}/*_kernels.cpp)
  if(kernel_sources)
    list(REMOVE_ITEM sources ${kernel_sources})
    foreach(path ${kernel_paths})
      haptic_cloth_objects(${layer}_${path} ${layer} ${kernel_sources})
      target_compile_definitions(${layer}_${path} PRIVATE
        HAPTIC_CLOTH_PATH=${path} HAPTIC_CLOTH_LANES=${kernel_lanes_${path}})
      target_compile_options(${layer}_${path} PRIVATE ${kernel_flags_${path}})
    endforeach()
  endif()
  if(sources)
    haptic_cloth_objects(${layer}_objects ${layer} ${sources})
  endif()
endmacro()

haptic_cloth_layer(parallel)
haptic_cloth_layer(simd)
haptic_cloth_layer(state)
haptic_cloth_layer(solver parallel)
haptic_cloth_layer(fabric state)
haptic_cloth_layer(mesh parallel simd state)
haptic_cloth_layer(energy fabric mesh)
haptic_cloth_layer(shape simd)
haptic_cloth_layer(contact mesh shape)
haptic_cloth_layer(scene fabric shape state)
haptic_cloth_layer(sim energy contact scene solver)
haptic_cloth_layer(haptics sim)

target_compile_definitions(haptic_cloth_simd_objects PRIVATE HAPTIC_CLOTH_X86=${HAPTIC_CLOTH_X86})
target_compile_definitions(haptic_cloth_fabric_objects PRIVATE
  HAPTIC_CLOTH_SOURCE_FABRICS="${PROJECT_SOURCE_DIR}/config/fabrics"
  HAPTIC_CLOTH_INSTALL_FABRICS="${CMAKE_INSTALL_PREFIX}/share/haptic_cloth/config/fabrics")
target_link_libraries(haptic_cloth_fabric INTERFACE yaml-cpp)
# Its exact sums need products and sums that are rounded one by one.
set_source_files_properties(src/contact/crossings.cpp PROPERTIES COMPILE_OPTIONS -ffp-contract=off)
