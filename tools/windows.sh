#!/bin/bash
# tools/windows.sh [TEST...]: g3r for Windows on x86-64, made on Debian 12 with its MinGW-w64 and all other libraries inside
# (cmake/toolchains/windows.cmake): build/windows/cli/g3r.exe, which goes with build/windows/licences. Then the tests that are named run
# under Wine, by default those of files and their ends; tests/CMakeLists.txt says which need POSIX. Installs what is missing, as root or with
# sudo.
# Not part of .ci/run.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/prepare.sh
prefix=$PWD/build/windows-prefix
toolchain=(-G Ninja "-DCMAKE_TOOLCHAIN_FILE=$PWD/cmake/toolchains/windows.cmake" -DCMAKE_BUILD_TYPE=Release "-DCMAKE_PREFIX_PATH=$prefix")
tests=("$@")
if [ ${#tests[@]} -eq 0 ]; then
  tests=(platform_test cli_replace_test)
fi
targets=(g3r_cli)
for name in "${tests[@]}"; do
  if [ -e "tests/$name.cpp" ]; then targets+=("$name"); fi # the others are scripts
done

install_packages
install_packages tools/windows_packages.txt
tools/sources.sh all

cli_headers "$prefix"
google_test "$prefix" "${toolchain[@]}"
cmake --log-level=WARNING "${toolchain[@]}" -S . -B build/windows -DG3R_BUNDLED=ON -DG3R_INSTALL=OFF -DG3R_BUILD_BENCH=OFF \
  -DG3R_BUILD_EXAMPLES=OFF -DG3R_PRECOMPILE=ON -DCMAKE_CROSSCOMPILING_EMULATOR=/usr/lib/wine/wine64
cmake --build build/windows --target "${targets[@]}"
cmake --install build/windows --component licences --prefix build/windows/licences

# Wine takes names of files as the locale writes them.
export WINEPREFIX=$PWD/build/wine WINEDEBUG=-all WINEDLLOVERRIDES='mscoree=;mshtml=' LC_ALL=C.UTF-8
mkdir -p "$WINEPREFIX"
# What Wine starts beside the first program would hold that program's pipes open, and the test wait for it.
/usr/lib/wine/wineserver64 -p
trap '/usr/lib/wine/wineserver64 -k' EXIT
/usr/lib/wine/wine64 cmd /c exit < /dev/null > /dev/null 2>&1
ctest --test-dir build/windows --output-on-failure --no-tests=error -R "^($(IFS='|' && echo "${tests[*]}"))\$"
