#!/usr/bin/env bash
# Shows a hand on a cloth: installs, builds, starts rviz if there is a screen, reports each second.
# Usage: scripts/demo.sh [--seconds N] [launch arguments]
#   scene:=fold  a fingertip folds a corner over and presses the fold; also two_fingers, or a file
#   --seconds N  ends after N seconds with a verdict; exit status 0 only if force, markers and state were
#                published at their rates and were finite
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"

seconds=0
arguments=()
while [ $# -gt 0 ]; do
  case "$1" in
    -h | --help) sed -n 2,6p "$0"; exit 0 ;;
    --seconds) seconds="${2:-}"; shift $(($# > 1)) ;;
    --seconds=*) seconds="${1#*=}" ;;
    *:=*) arguments+=("$1") ;;
    *) echo "demo.sh: unknown argument $1; see demo.sh --help" >&2; exit 2 ;;
  esac
  shift
done
if ! [[ "$seconds" =~ ^[0-9]+([.][0-9]+)?$ ]]; then
  echo "demo.sh: --seconds must be a number, got '$seconds'" >&2
  exit 2
fi

launch_file="$here/../launch/demo.launch"
if ! [ -f "$launch_file" ]; then launch_file="$(rospack find haptic_cloth)/launch/demo.launch"; fi
known="$(sed -n 's/^  <arg name="\([a-z_]*\)" default.*/\1/p' "$launch_file" | xargs)"
for argument in ${arguments[@]+"${arguments[@]}"}; do
  if ! [[ " $known " == *" ${argument%%:=*} "* ]]; then
    echo "demo.sh: $argument: demo.launch has only $known" >&2
    exit 2
  fi
done

# In the source tree, installs and builds first. An installed copy uses the caller's environment.
if [ -f "$here/../CMakeLists.txt" ]; then
  "$here/install_deps.sh"
  TARGETS="haptic_cloth_node hand mouse_hand path_hand monitor haptic_cloth_generate_messages" "$here/build.sh"
  set +u
  source "${BUILD_DIR:-$here/../build}/devel/setup.bash"
  set -u
fi
export ROS_HOSTNAME="${ROS_HOSTNAME:-localhost}"

rviz=false
if [ -n "${DISPLAY:-}" ]; then rviz=true; fi

log="$(mktemp)"
roslaunch haptic_cloth demo.launch "rviz:=$rviz" ${arguments[@]+"${arguments[@]}"} >"$log" 2>&1 &
launch=$!
monitor=
finish() {
  for process in $monitor $launch; do kill -TERM "$process" 2>/dev/null || true; done
  wait 2>/dev/null || true
  rm -f "$log"
}
trap finish EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

launch_died() {
  cat "$log" >&2
  echo "FAIL: the launch ended" >&2
  exit 1
}

# A ROS master that runs already holds the parameters of earlier launches until this one starts its nodes.
until grep -q 'process\[.*haptic_cloth-' "$log"; do
  kill -0 "$launch" 2>/dev/null || launch_died
  sleep 0.2
done

rosrun haptic_cloth monitor "_seconds:=$seconds" &
monitor=$!
status=0
wait -n "$launch" "$monitor" || status=$?
if ! kill -0 "$launch" 2>/dev/null; then launch_died; fi
exit "$status"
