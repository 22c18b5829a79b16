#!/usr/bin/env bash
# Installs the packages for build, tests and demonstration (the only list), if any are missing.
# Usage: scripts/install_deps.sh [--lint]     --lint: also the packages for scripts/lint.sh
set -euo pipefail
case "${1:-}" in -h | --help) sed -n 2,3p "$0"; exit 0 ;; esac

common=(build-essential cmake libeigen3-dev libgtest-dev libyaml-cpp-dev libboost-program-options-dev nlohmann-json3-dev libbenchmark-dev libcgal-dev valgrind)
# Debian 12 has ROS 1 in its own archive.
debian=(catkin libroscpp-dev pluginlib-dev libtf2-ros-dev libtf2-msgs-dev libtopic-tools-dev libdynamic-reconfigure-config-init-mutex-dev libinteractive-markers-dev librostest-dev libnodeletlib-dev libnodeletlib-tools librosbag-dev
        ros-geometry-msgs libstd-msgs-dev libstd-srvs-dev libgeometry-msgs-dev libsensor-msgs-dev libvisualization-msgs-dev
        libdiagnostic-msgs-dev ros-message-generation python3-dynamic-reconfigure python3-visualization-msgs python3-std-srvs
        python3-diagnostic-msgs python3-rostest python3-roslaunch python3-rostopic python3-rosbag python3-rosnode python3-rosservice rosbash rviz)
# Ubuntu 20.04 uses packages.ros.org.
noetic=(ros-noetic-ros-base ros-noetic-rostest ros-noetic-nodelet ros-noetic-tf2-ros ros-noetic-tf2-msgs ros-noetic-dynamic-reconfigure ros-noetic-interactive-markers ros-noetic-visualization-msgs
        ros-noetic-diagnostic-msgs ros-noetic-rviz)
# For libFuzzer and, with libomp, the thread sanitizer: about 50 MB.
fuzz=(clang libclang-rt-dev libomp-dev)
show=(xvfb xauth imagemagick x11-utils python3-matplotlib python3-numpy)
lint=(catkin-lint clang-format clang-tidy doxygen)

packages=("${common[@]}")
if [ -d /opt/ros/noetic ]; then packages+=("${noetic[@]}"); else packages+=("${debian[@]}"); fi
packages+=("${show[@]}" "${fuzz[@]}")
if [ "${1:-}" = --lint ]; then packages+=("${lint[@]}"); fi

installed() { dpkg-query -W -f '${Status}' "$1" 2>/dev/null | grep -q 'ok installed'; }
missing=()
for package in "${packages[@]}"; do installed "$package" || missing+=("$package"); done
if [ ${#missing[@]} -eq 0 ]; then exit 0; fi

root=()
if [ "$(id -u)" -ne 0 ]; then root=(sudo); fi
echo "installing: ${missing[*]}"
"${root[@]}" apt-get update -q
wanted=()
for package in "${missing[@]}"; do
  if apt-cache show "$package" >/dev/null 2>&1; then wanted+=("$package"); else echo "not available: $package"; fi
done
DEBIAN_FRONTEND=noninteractive "${root[@]}" apt-get install -q -y --no-install-recommends "${wanted[@]}"
