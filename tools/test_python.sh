#!/bin/sh
# Builds the Python package in a fresh virtual environment and runs its tests. PYTHON chooses the interpreter (3.9 or newer).
set -eu
cd "$(dirname "$0")/.."
python=${PYTHON:-python3}
environment=$PWD/build/python/venv-$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
"$python" -m venv --clear "$environment"
"$environment/bin/pip" install --quiet --disable-pip-version-check --config-settings cmake.define.G3R_WARNINGS_AS_ERRORS=ON '.[test,dask]'
cd "$environment"  # away from the sources, so that the installed package is tested
exec "$environment/bin/python" -m pytest -q -p no:cacheprovider "$OLDPWD/python/tests" "$@"
