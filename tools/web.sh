#!/bin/bash
# tools/web.sh [test]: makes build/web/g3r.html, g3r for browsers in one file (docs/browser.md), with Debian's Emscripten. With "test" it also
# builds the program, with threads and without, compares the bytes of their results, and tries the page in a Chromium without a display.
set -euo pipefail
cd "$(dirname "$0")/.."
if [ $# -gt 1 ] || [ "${1:-test}" != test ]; then
  echo "usage: tools/web.sh [test]" >&2
  exit 64
fi
. tools/prepare.sh
for program in emcc ${1:+chromium}; do
  if ! command -v "$program" > /dev/null; then
    echo "$program is missing: apt-get install --no-install-recommends emscripten${1:+ chromium}" >&2
    exit 1
  fi
done
tools/sources.sh all
# Emscripten's own scripts look for their libraries where Debian's node does; other nodes have to be told.
NODE_PATH=/usr/share/nodejs build web
if [ "${1:-}" = test ]; then
  build release g3r_cli
  cmake --preset release -B build/serial --log-level=WARNING -DG3R_THREADS=OFF -DG3R_BUILD_TESTS=OFF -DG3R_BUILD_BENCH=OFF -DG3R_INSTALL=OFF
  cmake --build build/serial --target g3r_cli
  G3R_PAGE=build/web/g3r.html G3R_PROGRAM=$PWD/build/release/cli/g3r G3R_SERIAL=$PWD/build/serial/cli/g3r python3 tests/web_test.py
fi
