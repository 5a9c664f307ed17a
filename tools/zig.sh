# Sourced by tools/wheels.sh and tools/macos.sh: zig (PyPI ziglang) as a compiler for other systems and processors.

# environment PYTHON FOLDER PACKAGE...: a virtual environment with these packages.
environment() {
  [ -x "$2/bin/pip" ] || "$1" -m venv "$2"
  "$2/bin/pip" install --quiet --disable-pip-version-check "${@:3}"
}

# write FILE: standard input, unless it has it already, so that what depends on its age is not made again.
write() {
  local text
  text=$(cat)
  [ "$(cat "$1" 2> /dev/null)" = "$text" ] || echo "$text" > "$1"
}

# zig_toolchain PYTHON FOLDER SYSTEM ARCH TARGET: FOLDER/ARCH.cmake, CMake's toolchain with the zig of that Python for TARGET, zig's name.
zig_toolchain() {
  local zig tool
  zig=$("$1" -c 'import os, ziglang; print(os.path.join(os.path.dirname(ziglang.__file__), "zig"))')
  mkdir -p "$2"
  for tool in cc c++; do printf '#!/bin/sh\nexec "%s" %s -target %s "$@"\n' "$zig" $tool "$5" | write "$2/$4-$tool"; done
  for tool in ar ranlib; do printf '#!/bin/sh\nexec "%s" %s "$@"\n' "$zig" $tool | write "$2/$tool"; done
  chmod +x "$2"/*
  write "$2/$4.cmake" << END
set(CMAKE_SYSTEM_NAME $3)
set(CMAKE_SYSTEM_PROCESSOR $4)
set(CMAKE_C_COMPILER "$2/$4-cc")
set(CMAKE_CXX_COMPILER "$2/$4-c++")
set(CMAKE_AR "$2/ar")
set(CMAKE_RANLIB "$2/ranlib")
set(CMAKE_INSTALL_NAME_TOOL true) # CMake asks for one where the system is Darwin; nothing is installed
set(G3R_PRECOMPILE OFF) # zig has a cache of its own
END
}
