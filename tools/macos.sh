#!/bin/bash
# tools/macos.sh [ARCH...]: g3r for macOS 11 and newer on x86_64 and arm64 (default: both), compiled and linked on Debian 12 by zig, which
# has Apple's interfaces, with all other libraries inside: build/macos/ARCH/cli/g3r, which goes with build/macos/ARCH/licences.
# It is not run.
# Needs PyPI, and the network once (tools/sources.sh). Not part of .ci/run.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/prepare.sh
. tools/zig.sh
out=$PWD/build/macos
system=11.0
prefix=$out/prefix

install_packages
tools/sources.sh all
environment python3 "$out/tools" ziglang
cli_headers "$prefix"

if [ $# -eq 0 ]; then set -- x86_64 arm64; fi
for arch in "$@"; do
  zig_toolchain "$out/tools/bin/python" "$out/zig" Darwin "$arch" "${arch/arm64/aarch64}-macos.$system"
  cmake -G Ninja --log-level=WARNING -S . -B "$out/$arch" "-DCMAKE_TOOLCHAIN_FILE=$out/zig/$arch.cmake" -DCMAKE_BUILD_TYPE=Release \
    "-DCMAKE_PREFIX_PATH=$prefix" -DCMAKE_OSX_SYSROOT= -DCMAKE_OSX_ARCHITECTURES= -DCMAKE_OSX_DEPLOYMENT_TARGET= -DG3R_BUNDLED=ON \
    -DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF -DG3R_INSTALL=OFF -DG3R_BUILD_TESTS=OFF -DG3R_BUILD_BENCH=OFF -DG3R_BUILD_EXAMPLES=OFF
  cmake --build "$out/$arch" --target g3r_cli
  cmake --install "$out/$arch" --component licences --prefix "$out/$arch/licences"
  ls -l "$out/$arch/cli/g3r"
done
