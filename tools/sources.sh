#!/bin/bash
# tools/sources.sh [all]: brings the sources of LASzip (Apache License 2.0; reads and writes LAZ) and of libE57Format (Boost Software License
# 1.0; reads E57) to build/sources, where every build takes them from. Debian 12 has no packages of them: they come from the source
# distributions of laszip and pye57 on PyPI, of which only the libraries are kept. With "all" also those of the other libraries, for builds
# that have to have them inside (cmake/Libraries.cmake) and the source distribution. These come from Debian 12.
# All are pinned versions, held against their checksums. The archives stay in the cache of the user ($G3R_CACHE, else $XDG_CACHE_HOME/g3r,
# else ~/.cache/g3r), so that the network is needed once.
# Exit status 1, with a line for each library that says why, where there are neither: then builds leave these formats out.
set -euo pipefail
cd "$(dirname "$0")/.."
cache=${G3R_CACHE:-${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/g3r}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset PYTHONPATH # of a build of the Python package, around this

# has_checksum FILE SUM
has_checksum() { [ -e "$1" ] && echo "$2  $1" | sha256sum --check --status; }

# from_pypi NAME-VERSION.tar.gz SUM: the source distribution to $work, also where it is for newer Pythons. pip asks a package's build system
# for its name before it hands it over, and holds what it runs against checksums first: the archive, and what tools/sources_helpers.txt names.
from_pypi() {
  local archive=${1%.tar.gz}
  local python=$work/environment/bin/python pip options=(--quiet --disable-pip-version-check --retries 1 --timeout 10)
  if [ ! -x "$python" ]; then
    python3 -m venv --without-pip "$work/environment" || return 1
    # A pip of its own takes three seconds to install: most systems have one that serves any environment.
    python3 -m pip --python "$python" --version > /dev/null 2>&1 || "$python" -m ensurepip > /dev/null || return 1
  fi
  pip=(python3 -m pip --python "$python" "${options[@]}")
  [ ! -x "$work/environment/bin/pip3" ] || pip=("$python" -m pip "${options[@]}")
  "${pip[@]}" install --no-deps --only-binary :all: --require-hashes -r tools/sources_helpers.txt || return 1
  echo "${archive%-*}==${archive##*-} --hash=sha256:$2" > "$work/requirement.txt" || return 1
  "${pip[@]}" download --no-deps --ignore-requires-python --no-build-isolation --no-binary :all: --require-hashes \
    --dest "$work" -r "$work/requirement.txt"
}

# apt ARGUMENT...: apt-get with lists of its own, of the packages and the sources of the system's Debian, so that the system's own stay as they are.
apt() {
  apt-get -q -o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts="$work/apt/parts" -o Dir::State::Lists="$work/apt/lists" \
    -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache= -o APT::Sandbox::User=root "$@"
}

# from_debian PACKAGE_VERSION.EXTENSION SUM: a source archive as its authors made it, or a package of headers, to $work.
from_debian() {
  if [ ! -d "$work/apt" ]; then
    mkdir -p "$work/apt/lists/partial" "$work/apt/parts" || return 1
    local list
    for list in /etc/apt/sources.list /etc/apt/sources.list.d/debian.*; do
      case $list in
        *.list) sed -n 's/^deb \(.*\)/deb \1\ndeb-src \1/p' "$list" > "$work/apt/parts/system.list" ;;
        *.sources) sed 's/^Types: .*/Types: deb deb-src/' "$list" > "$work/apt/parts/system.sources" ;;
      esac
    done 2> /dev/null
    apt update || return 1
  fi
  case $1 in
    *.deb) (cd "$work" && apt download "${1%%_*}") ;;
    *) (cd "$work" && apt source --download-only --tar-only "${1%%_*}") ;;
  esac
}

# keep FILE: in the cache. Where nothing can be written there, the next build needs the network again.
keep() {
  local kept
  kept=$cache/$(basename "$1")
  if ! { mkdir -p "$cache" && cp "$1" "$kept.$$" && mv "$kept.$$" "$kept"; } 2> /dev/null; then
    rm -f "$kept.$$" 2> /dev/null || true
  fi
}

# unpack ARCHIVE FOLDER TAR-OPTION...
unpack() {
  if [[ $1 == *.deb ]]; then
    dpkg-deb --fsys-tarfile "$1" | tar -x -C "$2" --wildcards --transform 's,^./usr/include/\(eigen3/\)\?,,;s,.*/copyright$,copyright,' \
      "${@:3}" './usr/share/doc/*/copyright'
  else
    tar -xf "$1" -C "$2" --strip-components=1 --wildcards "${@:3}"
  fi
}

# complaint: the last line of the log that is called an error, else the last line.
complaint() { grep -E '^(ERROR|E):' "$work/log" | tail -n 1 | grep . || grep '[^ ]' "$work/log" | tail -n 1; }

# fetch FOLDER HOME ARCHIVE SUM TAR-OPTION...: what tar extracts from the archive becomes build/sources/FOLDER. HOME: from_pypi, from_debian.
# Where it fails, `why` says it.
fetch() {
  local folder=build/sources/$1 archive=$cache/$3
  [ "$(cat "$folder/checksum" 2> /dev/null)" != "$4" ] || return 0
  if ! has_checksum "$archive" "$4"; then
    archive=$work/$3
    if ! "$2" "$3" "$4" > "$work/log" 2>&1; then
      why="$3 is not in $cache and cannot be fetched: $(complaint)"
      return 1
    elif [ ! -e "$archive" ]; then
      why="$3 is of Debian 12, and the Debian of this system has another version"
      return 1
    elif ! has_checksum "$archive" "$4"; then
      why="$3 has another checksum than $4"
      return 1
    fi
    keep "$archive"
  fi
  why="$3 cannot be unpacked to build/sources"
  mkdir "$work/$1" || return 1
  unpack "$archive" "$work/$1" "${@:5}" || return 1
  echo "$4" > "$work/$1/checksum" && mkdir -p build/sources && rm -rf "$folder" && mv "$work/$1" "$folder"
}

# missing NAME: says that fetch has failed, and why.
missing() {
  echo "$1: no sources: built without ($why)" >&2
  status=1
}

status=0
fetch laszip from_pypi laszip-0.3.0.tar.gz 9ddf91649b519db308f63d772a19e7647458f5d5512e3d927629f0196b9c6216 --strip-components=4 \
  'laszip-0.3.0/src/vendor/LASzip-*/src' 'laszip-0.3.0/src/vendor/LASzip-*/include' 'laszip-0.3.0/src/vendor/LASzip-*/COPYING.txt' || missing LAZ
fetch e57 from_pypi pye57-0.4.19.tar.gz 0323a0cb5e62286fb3f4d7a2c63d811bb813ac65e2a21cfadf8ca848eaa27101 --strip-components=2 \
  'pye57-0.4.19/libE57Format/*' --exclude 'pye57-0.4.19/libE57Format/test' || missing E57
if [ "${1:-}" = all ]; then
  fetch tbb from_debian onetbb_2021.8.0.orig.tar.xz 7e9111b8bb59c8800bf6d0b06afe7b0891937443d2dae1ee1101c8e2ede6a7ef \
    '*/include' '*/src/tbb' '*/LICENSE.txt' || missing oneTBB
  fetch highway from_debian highway_1.0.3.orig.tar.gz 566fc77315878473d9a6bd815f7de78c73734acdcb745c3dde8579560ac5440e \
    '*/hwy' '*/LICENSE' --exclude '*/contrib' --exclude '*/tests' --exclude '*_test.cc' || missing Highway
  fetch png from_debian libpng1.6_1.6.39.orig.tar.gz a00e9d2f2f664186e4202db9299397f851aea71b36a35e74910b8820e380d441 \
    --no-wildcards-match-slash '*/*.c' '*/*.h' '*/scripts/pnglibconf.h.prebuilt' '*/LICENSE' || missing libpng
  fetch zlib from_debian zlib_1.2.13.dfsg.orig.tar.bz2 71feb7947e3c00ef125f83b79a4e529bde31171e5babe48b391f06758d1ab0a1 \
    --no-wildcards-match-slash '*/*.c' '*/*.h' '*/README' || missing zlib
  fetch eigen from_debian libeigen3-dev_3.4.0-4_all.deb 1a167bb381acb90c1d8450a8f3e66a09d216dbc64b33ac8a082a0912513ef939 \
    ./usr/include/eigen3/Eigen || missing Eigen
  fetch json from_debian nlohmann-json3-dev_3.11.2-2_all.deb ec57940def6b6186c30be0e0ee81d1e58f86d11a54a145b28686a1e3e4aae801 \
    ./usr/include/nlohmann || missing nlohmann-json
fi
exit $status
