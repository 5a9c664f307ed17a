# Sourced by tools/wheels.sh, after tools/zig.sh: what is made for another processor, run by qemu-user with Debian's libraries for it.

# emulated_system ARCH SUITE FOLDER: Python 3 of that suite of Debian and all that it needs, for ARCH, unpacked in FOLDER; nothing is
# installed. FOLDER/usr/bin/python is that Python in the emulator, and FOLDER/run PROGRAM... any program.
emulated_system() {
  if [ -x "$3/usr/bin/python" ]; then return; fi
  local state=$3.apt package
  local -A names=([x86_64]=amd64 [aarch64]=arm64)
  mkdir -p "$3" "$state/parts" "$state/lists/partial" "$state/cache/archives/partial"
  echo "deb http://deb.debian.org/debian $2 main" > "$state/parts/debian.list"
  : > "$state/status"
  local apt=(apt-get -qq -o Dir::Etc::SourceList=/dev/null -o "Dir::Etc::SourceParts=$state/parts" -o "Dir::State=$state"
    -o "Dir::State::Lists=$state/lists" -o "Dir::State::status=$state/status" -o "Dir::Cache=$state/cache" -o Dir::Cache::pkgcache=
    -o Dir::Cache::srcpkgcache= -o APT::Sandbox::User=root -o "APT::Architecture=${names[$1]}" -o "APT::Architectures=${names[$1]}"
    -o APT::Install-Recommends=false)
  "${apt[@]}" update
  "${apt[@]}" --download-only install python3 libstdc++6 > /dev/null
  for package in "$state"/cache/archives/*.deb; do dpkg-deb -x "$package" "$3"; done
  [ -e "$3/lib" ] || ln -s usr/lib "$3/lib" # Debian 13 and newer have it in a package that Python does not ask for
  printf '#!/bin/sh\nexec qemu-%s -L "%s" "$@"\n' "$1" "$3" > "$3/run"
  # Python finds its own folders, and programs start it again, by the name that it is called by.
  printf '#!/bin/sh\nexec "%s/run" -0 "$0" "%s" "$@"\n' "$3" "$(realpath "$3/usr/bin/python3")" > "$3/usr/bin/python"
  chmod +x "$3/run" "$3/usr/bin/python"
}

# emulated_packages ARCH MINOR FOLDER PACKAGE...: packages of PyPI, and files, for Python 3.MINOR on ARCH, to FOLDER.
emulated_packages() {
  local platforms=() platform
  for platform in manylinux_2_28 manylinux_2_27 manylinux_2_17 manylinux2014; do platforms+=(--platform "${platform}_$1"); done
  rm -rf "$3"
  "$out/tools/bin/pip" install --quiet --disable-pip-version-check --target "$3" --only-binary=:all: "${platforms[@]}" \
    --python-version "3.$2" "${@:4}"
}

# emulated_tests FOLDER SYSTEM TEST...: the program and these tests, of the library that is built in FOLDER, run in the emulator of SYSTEM.
emulated_tests() {
  local PATH=$out/tools/bin:$PATH prefix=$1-prefix toolchain name targets=(g3r_cli)
  toolchain=$(sed -n 's/^CMAKE_TOOLCHAIN_FILE:[A-Z]*=//p' "$1/CMakeCache.txt")
  for name in "${@:3}"; do
    if [ -e "tests/$name.cpp" ]; then targets+=("$name"); fi # the others are scripts
  done
  cli_headers "$prefix"
  google_test "$prefix" -G Ninja "-DCMAKE_TOOLCHAIN_FILE=$toolchain" -DCMAKE_BUILD_TYPE=Release
  cmake --log-level=WARNING "$1" "-DCMAKE_PREFIX_PATH=$prefix" "-DCMAKE_CROSSCOMPILING_EMULATOR=$2/run" -DG3R_BUILD_PYTHON=OFF \
    -DG3R_BUILD_CLI=ON -DG3R_BUILD_TESTS=ON
  cmake --build "$1" --target "${targets[@]}"
  ctest --test-dir "$1" --output-on-failure --no-tests=error -R "^($(IFS='|' && echo "${*:3}"))\$"
}
