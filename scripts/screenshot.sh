#!/usr/bin/env bash
# Takes a picture of the demonstration without a screen: screenshot.sh [OUT.png] [scene:=FILE ...]
# Needs a build. Waits for SIMULATED seconds and a force of FORCE newton on any probe. Example:
# FORCE=0.2 scripts/screenshot.sh fingers.png scene:=two_fingers
# With MOMENTS it takes one picture at each of these simulated times, without a look at the force, and sets them side by
# side: MOMENTS="1.6 2.9 5.3" scripts/screenshot.sh docs/images/fold.png scene:=fold
# Fails, and leaves OUT.png alone, if rviz has not drawn CLOTH_PIXELS (10000) pixels of cloth after DRAW_TIMEOUT (120)
# seconds, or if the wait takes more than TIMEOUT (180) seconds.
set -euo pipefail
case "${1:-}" in -h | --help) sed -n 2,8p "$0"; exit 0 ;; esac
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

log="$(mktemp)"
pictures="$(mktemp -d)"
picture="$pictures/newest.png"
roslaunch -p "$port" haptic_cloth demo.launch rviz_options:=--disable-anti-aliasing "$@" >"$log" 2>&1 &
launch=$!
trap 'kill -TERM "$launch" 2>/dev/null; wait "$launch" 2>/dev/null || true; rm -rf "$log" "$pictures"' EXIT

fail() {
  tail -n 20 "$log" >&2
  echo "screenshot: $1" >&2
  exit 1
}

# Takes the picture. False, with the reason in `found`, where it does not show the cloth's blue.
wanted="${CLOTH_PIXELS:-10000}"
shows_cloth() {
  local pixels colours
  import -silent -window root "$picture"
  read -r pixels colours < <(convert "$picture" -depth 8 rgb:- | /usr/bin/python3 -c '
import sys, numpy
r, g, b = numpy.frombuffer(sys.stdin.buffer.read(), numpy.uint8).reshape(-1, 3).astype(int).T
print(numpy.count_nonzero((b > 60) & (b > 1.4 * r) & (b > 1.2 * g)), numpy.unique((r << 16) + (g << 8) + b).size)')
  found="the picture has $colours colours and $pixels pixels of cloth, at least $wanted are needed"
  [ "$pixels" -ge "$wanted" ]
}

# Waits for the cloth and takes the picture: take SIMULATED FORCE [WINDOW].
take() {
  for _ in 1 2 3; do
    "$root/scripts/wait_for_press.py" "$1" "${TIMEOUT:-180}" "${@:2}" || fail "the wait was too long"
    sleep 0.3  # until rviz has drawn what was felt
    if shows_cloth; then return; fi
  done
  fail "rviz does not draw the cloth any more: $found"
}

# A first start of rviz can take a minute.
end=$((SECONDS + ${DRAW_TIMEOUT:-120}))
until shows_cloth; do
  kill -0 "$launch" 2>/dev/null || fail "the launch ended"
  [ "$SECONDS" -lt "$end" ] || fail "rviz has not drawn the cloth: $found"
  sleep 0.5
done
if [ -z "${MOMENTS:-}" ]; then
  take "${SIMULATED:-1.0}" "${FORCE:-0.8}"
  cp "$picture" "$out"
else
  for moment in $MOMENTS; do
    take "$moment" 0 0.1
    convert "$picture" -crop 660x520+484+170 +repage "$pictures/at_$moment.png"  # the cloth without rviz's panels
  done
  # shellcheck disable=SC2086
  convert $(printf "$pictures/at_%s.png " $MOMENTS) +append -resize 1280x "$out"
fi
chmod a+r "$out"
echo "$out"
