#!/bin/bash
# From a bare Debian 12 machine to a tested build: installs what is missing, builds everything, runs every test.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/prepare.sh

prepare
build release
ctest --preset release
