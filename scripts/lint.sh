#!/usr/bin/env bash
# Checks layout, package and documents. Usage: scripts/lint.sh [--fix]   (structure: a unit test)
set -euo pipefail
case "${1:-}" in -h | --help) sed -n 2,2p "$0"; exit 0 ;; esac
cd "$(dirname "$0")/.."

missing=()
command -v clang-format >/dev/null || missing+=(clang-format)
command -v catkin_lint >/dev/null || missing+=(catkin-lint)
if [ ${#missing[@]} -gt 0 ]; then
  echo "lint: not installed: ${missing[*]} (scripts/install_deps.sh --lint, or apt-get install ${missing[*]})" >&2
  exit 2
fi

# The version stands in three files, and the CHANGELOG dates it.
package="$(sed -n 's|.*<version>\(.*\)</version>.*|\1|p' package.xml)"
cmake="$(sed -n 's/^project(.* VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)"
changelog="$(sed -n 's/^\([0-9.]*\) ([0-9]*-[0-9]*-[0-9]*)$/\1/p' CHANGELOG.rst | head -n 1)"
if [ -z "$package" ] || [ "$package" != "$cmake" ] || [ "$package" != "$changelog" ]; then
  echo "version: package.xml has '$package', CMakeLists.txt '$cmake', CHANGELOG.rst '$changelog'" >&2
  exit 1
fi

mapfile -t files < <(git ls-files --cached --others --exclude-standard '*.h' '*.cpp')
if [ "${1:-}" = --fix ]; then
  clang-format -i "${files[@]}"
else
  clang-format --dry-run -Werror "${files[@]}"
fi
# Ignored by design: benches are not installed and search their own packages, and the plot script is
# not a program.
ignored=(uninstalled_script missing_required env_var uninstalled_target wrong_bin_install_destination duplicate_find
         external_interface_path)
catkin_lint --quiet -W1 --strict "${ignored[@]/#/--ignore=}" . 2>&1 | { ! grep -E "(error|warning):"; }
for script in scripts/*.sh .ci/run; do bash -n "$script"; done
scripts/check_docs.py
if command -v doxygen >/dev/null; then
  mkdir -p build
  doxygen docs/Doxyfile
else
  echo "doxygen not found: the comments of the public headers are not checked"
fi
for script in scripts/*.py test/ros/*/*.py; do
  head -n 1 "$script" | grep -qx '#!/usr/bin/python3' || { echo "$script: must start with #!/usr/bin/python3"; exit 1; }
done
echo "lint: clean"
