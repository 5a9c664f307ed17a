#!/bin/sh
# Builds the Python package in a fresh virtual environment and runs its tests. PYTHON chooses the interpreter (3.9 or newer). With
# G3R_BUILT=FOLDER in the environment it is built with the library that was built there (build/release), which takes a fifth of the time.
set -eu
cd "$(dirname "$0")/.."
python=${PYTHON:-python3}
environment=$PWD/build/python/venv-$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
"$python" -m venv --clear "$environment"
library=
if [ -n "${G3R_BUILT:-}" ]; then
  library=$environment/library
  for component in runtime development; do cmake --install "$G3R_BUILT" --prefix "$library" --component $component > /dev/null; done
fi
"$environment/bin/pip" install --quiet --disable-pip-version-check --config-settings cmake.define.G3R_WARNINGS_AS_ERRORS=ON \
  ${library:+--config-settings cmake.define.G3R_INSTALLED=ON --config-settings cmake.define.CMAKE_PREFIX_PATH="$library"} '.[test,dask]'
cd "$environment"  # away from the sources, so that the installed package is tested
exec "$environment/bin/python" -m pytest -q -p no:cacheprovider "$OLDPWD/python/tests" "$@"
