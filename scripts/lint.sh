#!/usr/bin/env bash
# Layout, package and document checks. Usage: scripts/lint.sh [--fix]     (structure rules are a unit test)
set -euo pipefail
case "${1:-}" in -h | --help) sed -n 2,2p "$0"; exit 0 ;; esac
cd "$(dirname "$0")/.."
mapfile -t files < <(git ls-files --cached --others --exclude-standard '*.h' '*.cpp')
if [ "${1:-}" = --fix ]; then
  clang-format -i "${files[@]}"
else
  clang-format --dry-run -Werror "${files[@]}"
fi
# By design: benches are not installed and find again what they need, and the plot script is no program of its own.
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
for script in scripts/*.py test/ros/*.py; do
  head -n 1 "$script" | grep -qx '#!/usr/bin/python3' || { echo "$script: must start with #!/usr/bin/python3"; exit 1; }
done
echo "lint: clean"
