#!/usr/bin/env bash
# Takes a picture of the demonstration without a screen: screenshot.sh [OUT.png] [scene:=FILE ...]
# Needs a build. Waits for SIMULATED seconds and a force of FORCE newton on any probe. Example:
# FORCE=0.2 scripts/screenshot.sh fingers.png scene:=config/scenes/two_fingers.yaml path:=true
set -euo pipefail
case "${1:-}" in -h | --help) sed -n 2,4p "$0"; exit 0 ;; esac
root="$(cd "$(dirname "$0")/.." && pwd)"
out="$root/docs/images/demo.png"
if [ $# -gt 0 ] && [[ "$1" == *.png ]]; then
  out="$1"
  shift
fi

if [ -z "${HAPTIC_CLOTH_XVFB:-}" ]; then
  exec env HAPTIC_CLOTH_XVFB=1 xvfb-run -a -s "-screen 0 1280x800x24" "$0" "$out" "$@"
fi

set +u
source "${BUILD_DIR:-$root/build}/devel/setup.bash"
set -u
export ROS_HOSTNAME="${ROS_HOSTNAME:-localhost}"
port="${PORT:-11399}"
export ROS_MASTER_URI="http://localhost:$port"
mkdir -p "$(dirname "$out")"

roslaunch -p "$port" haptic_cloth demo.launch rviz_options:=--disable-anti-aliasing "$@" >/dev/null 2>&1 &
launch=$!
trap 'kill -TERM "$launch" 2>/dev/null; wait "$launch" 2>/dev/null || true' EXIT

# Number of pixels on the screen in the blue of the cloth.
cloth_pixels() {
  import -silent -window root -depth 8 rgb:- | /usr/bin/python3 -c '
import sys
data = sys.stdin.buffer.read()
print(sum(b > 60 and b > 1.4 * r and b > 1.2 * g for r, g, b in zip(data[::3], data[1::3], data[2::3])))'
}
for _ in $(seq 60); do
  if [ "$(cloth_pixels)" -gt 10000 ]; then break; fi
  sleep 0.5
done
"$root/scripts/wait_for_press.py" "${SIMULATED:-1.0}" "${TIMEOUT:-180}" "${FORCE:-0.8}"
sleep 0.3  # until rviz has drawn the press
import -silent -window root "$out"
echo "$out"
