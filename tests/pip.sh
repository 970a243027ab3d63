#!/bin/sh
# SPDX-License-Identifier: MIT
# `pip install .` in a virtual environment with Debian's packages alone and without a network; then a run, a sweep and
# the program, in another folder.
#   sh tests/pip.sh [BUILD]   BUILD: a release build of Debian's Python that is taken; else all is built, in build/python3.*
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
if ! /usr/bin/python3 -c "import ensurepip, setuptools, wheel" 2>/dev/null; then
  echo "skipped: needs python3-venv, python3-setuptools and python3-wheel"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
if [ $# -gt 0 ]; then
  PALPATE_BUILD=$(cd "$1" && pwd)
  export PALPATE_BUILD
fi
# A copy, without what was built: pip leaves folders of its own there.
mkdir "$folder/source"
for part in CMakeLists.txt CITATION.cff LICENSE README.md configs framework packages.txt plugins pyproject.toml setup.py; do
  cp -r "$root/$part" "$folder/source"
done
/usr/bin/python3 -m venv --system-site-packages "$folder/env"
"$folder/env/bin/pip" install --quiet --no-index --no-build-isolation --no-deps "$folder/source"
cd "$folder/env"
unset PYTHONPATH PALPATE_BUILD
bin/python - <<'END'
import palpate
assert palpate.__file__.startswith(__import__("sys").prefix), palpate.__file__
run = palpate.run("configs/default.yaml", "taps=4", runs="runs")
sweep = palpate.sweep("configs/default.yaml", taps=3, seed=range(2), runs="runs")
assert len(run) == 4 and list(sweep.table["status"]) == ["done", "done"], sweep.table
assert run.surface.shape == (len(run.y), len(run.x))
END
bin/palpate status "$(ls -d runs/default/* | head -n 1)"
echo "pip: installed, ran and swept"
