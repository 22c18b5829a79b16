# Installs the built tree below WORK, and builds and runs a user's project there. Nothing is fetched.
# Usage: cmake -DSOURCE=... -DBUILD=... -DWORK=... -DCOMPILER=... -DCATKIN=TRUE|FALSE -P check.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "failed (${result}): ${ARGN}")
  endif()
endfunction()

file(REMOVE_RECURSE "${WORK}")
set(ENV{DESTDIR} "")
run(${CMAKE_COMMAND} --install "${BUILD}" --prefix "${WORK}/prefix")
file(COPY "${SOURCE}/test/consumer/CMakeLists.txt" "${SOURCE}/examples/hello_cloth.cpp"
  "${SOURCE}/examples/haptic_loop.cpp"
  DESTINATION "${WORK}/source")
run(${CMAKE_COMMAND} -S "${WORK}/source" -B "${WORK}/build" "-DCMAKE_PREFIX_PATH=${WORK}/prefix"
  "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCATKIN=${CATKIN}")
run(${CMAKE_COMMAND} --build "${WORK}/build")
run("${WORK}/build/by_target")
run("${WORK}/build/haptic_loop" --seconds 1)
if(CATKIN)
  run("${WORK}/build/by_variables")
endif()
run("${WORK}/prefix/lib/haptic_cloth/hello_cloth")
