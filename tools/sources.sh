#!/bin/bash
# tools/sources.sh: brings the sources of LASzip (Apache License 2.0; reads and writes LAZ) and of libE57Format (Boost Software License 1.0;
# reads E57) to build/sources, where every build takes them from. Debian 12 has no packages of them: they come from the source distributions
# of laszip and pye57 on PyPI, pinned versions held against their checksums, of which only the libraries are kept. The archives stay in the
# cache of the user ($G3R_CACHE, else $XDG_CACHE_HOME/g3r, else ~/.cache/g3r), so that the network is needed once.
# Exit status 1, with one line that says so, where there are neither: then builds leave these formats out.
set -euo pipefail
cd "$(dirname "$0")/.."
cache=${G3R_CACHE:-${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/g3r}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset PYTHONPATH # of a build of the Python package, around this

# has_checksum FILE SUM
has_checksum() { [ -e "$1" ] && echo "$2  $1" | sha256sum --check --status; }

# download NAME VERSION SUM: from PyPI to the cache. pip asks a package's build system for its name before it hands it over.
download() {
  local archive=$1-$2.tar.gz
  if [ ! -x "$work/environment/bin/pip" ]; then
    python3 -m venv "$work/environment" || return 1
  fi
  local pip=("$work/environment/bin/pip" --quiet --disable-pip-version-check --retries 1 --timeout 10)
  "${pip[@]}" install scikit-build-core setuptools wheel pybind11 || return 1
  "${pip[@]}" download --no-deps --no-build-isolation --no-binary :all: --dest "$work" "$1==$2" || return 1
  has_checksum "$work/$archive" "$3" || return 1
  mkdir -p "$cache" && cp "$work/$archive" "$cache/$archive.$$" && mv "$cache/$archive.$$" "$cache/$archive"
}

# fetch FOLDER NAME VERSION SUM TAR-OPTION...: what tar extracts from the archive becomes build/sources/FOLDER.
fetch() {
  local folder=build/sources/$1 archive=$cache/$2-$3.tar.gz
  [ "$(cat "$folder/version" 2> /dev/null)" != "$4" ] || return 0
  has_checksum "$archive" "$4" || download "$2" "$3" "$4" > "$work/log" 2>&1 || return 1
  mkdir "$work/$1"
  tar -xzf "$archive" -C "$work/$1" "${@:5}" || return 1
  echo "$4" > "$work/$1/version"
  mkdir -p build/sources
  rm -rf "$folder"
  mv "$work/$1" "$folder"
}

missing=()
fetch laszip laszip 0.3.0 9ddf91649b519db308f63d772a19e7647458f5d5512e3d927629f0196b9c6216 --strip-components=4 \
  --wildcards 'laszip-0.3.0/src/vendor/LASzip-*/*' || missing+=(LAZ)
fetch e57 pye57 0.4.19 0323a0cb5e62286fb3f4d7a2c63d811bb813ac65e2a21cfadf8ca848eaa27101 --strip-components=2 \
  --wildcards 'pye57-0.4.19/libE57Format/*' --exclude 'pye57-0.4.19/libE57Format/test' || missing+=(E57)
if [ ${#missing[@]} -ne 0 ]; then
  echo "${missing[*]}: no sources (PyPI cannot be reached, and they are not in $cache): built without" >&2
  tail -n 1 "$work/log" >&2 2> /dev/null || true
  exit 1
fi
