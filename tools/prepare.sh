# Sourced by the other scripts of this folder. Brings the machine to the point where the project can be built; does nothing if it is.

# install_packages [FILE]: installs what FILE, by default packages.txt, lists and this machine lacks (Debian 12; as root or through sudo).
install_packages() {
  local wanted missing=() package
  wanted=$(sed 's/#.*//' "${1:-packages.txt}")
  for package in $wanted; do
    dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || missing+=("$package")
  done
  if [ ${#missing[@]} -eq 0 ]; then return 0; fi
  echo "installing ${#missing[@]} packages: ${missing[*]}"
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "these packages are missing; install them as root: ${missing[*]}" >&2
      return 1
    fi
    as_root=(sudo)
  fi
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
}

# prepare: the packages, and the sources of LASzip and libE57Format; a build without these says so and reads no LAZ or E57.
prepare() {
  install_packages
  tools/sources.sh || true
}

# cli_headers PREFIX: CLI11, which is headers, where a build for another system looks for it; as old as it is, so that it is compiled once.
cli_headers() {
  mkdir -p "$1/include" "$1/share/cmake"
  cp -r --preserve=timestamps /usr/include/CLI "$1/include"
  cp -r /usr/share/cmake/CLI11 "$1/share/cmake"
}

# google_test PREFIX CMAKE-OPTION...: GoogleTest for another system, compiled from the sources that libgtest-dev brings.
google_test() {
  if [ -e "$1/lib/libgtest.a" ]; then return; fi
  cmake --log-level=WARNING "${@:2}" -S /usr/src/googletest -B "$1/gtest" -DBUILD_GMOCK=OFF "-DCMAKE_INSTALL_PREFIX=$1"
  cmake --build "$1/gtest" --target install
}

# build PRESET [TARGET...]: configures and builds the targets, all of them by default.
build() {
  local preset=$1
  shift
  cmake --preset "$preset" --log-level=WARNING
  cmake --build --preset "$preset" ${1:+--target "$@"}
}
