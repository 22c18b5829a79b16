#!/usr/bin/env bash
# Layout and package checks. Usage: scripts/lint.sh [--fix]     (structure rules are a unit test)
set -euo pipefail
cd "$(dirname "$0")/.."
mapfile -t files < <(git ls-files --cached --others --exclude-standard '*.h' '*.cpp')
if [ "${1:-}" = --fix ]; then
  clang-format -i "${files[@]}"
else
  clang-format --dry-run -Werror "${files[@]}"
fi
catkin_lint --quiet -W1 --strict --ignore uninstalled_script --ignore missing_required --ignore env_var . 2>&1 | { ! grep -E "(error|warning):"; }
for script in scripts/*.sh .ci/run; do bash -n "$script"; done
for script in scripts/*.py test/ros/*.py; do
  head -n 1 "$script" | grep -qx '#!/usr/bin/python3' || { echo "$script: must start with #!/usr/bin/python3"; exit 1; }
done
echo "lint: clean"
