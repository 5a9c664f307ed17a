#!/bin/bash
# From a bare Debian 12 machine to a tested build: installs what is missing, builds everything, runs every test.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/prepare.sh

install_packages
build release
ctest --preset release

# LAZ and E57, with libraries whose sources come from PyPI; then back to the default, without them.
if tools/laszip.sh build/laszip && tools/e57.sh build/e57; then
  cmake --preset release --log-level=WARNING -DG3R_LASZIP_SOURCE=build/laszip -DG3R_E57_SOURCE=build/e57
  cmake --build --preset release --target laz_test e57_test
  ctest --preset release -R '^(laz|e57)_test$'
  cmake --preset release --log-level=WARNING -DG3R_LASZIP_SOURCE= -DG3R_E57_SOURCE=
else
  echo "skipped: laz_test and e57_test, for whose libraries there are no sources (PyPI cannot be reached)"
fi
