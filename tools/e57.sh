#!/bin/bash
# tools/e57.sh DIR: fetches the sources of libE57Format (Boost Software License 1.0) into DIR, for a build that reads E57:
#   tools/e57.sh build/e57 && cmake --preset release -DG3R_E57_SOURCE=build/e57
# Debian 12 has no libE57Format, only Xerces-C++ (libxerces-c-dev), which it parses XML with. The sources come from the source distribution
# of the package pye57 on PyPI, of which only they are kept.
set -euo pipefail
folder=${1:?usage: tools/e57.sh DIR}
version=0.4.19
sum=0323a0cb5e62286fb3f4d7a2c63d811bb813ac65e2a21cfadf8ca848eaa27101
if [ -e "$folder/src/CompressedVectorReaderImpl.cpp" ]; then exit 0; fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/environment"
pip=("$work/environment/bin/pip" --quiet --disable-pip-version-check --retries 1)
"${pip[@]}" install setuptools wheel pybind11 # pip asks the package's build system for its name before it hands it over
"${pip[@]}" download --no-deps --no-build-isolation --no-binary :all: --dest "$work" "pye57==$version"
echo "$sum  $work/pye57-$version.tar.gz" | sha256sum --check --quiet
mkdir -p "$folder"
tar -xzf "$work/pye57-$version.tar.gz" -C "$folder" --strip-components=2 --wildcards "pye57-$version/libE57Format/*" \
  --exclude "pye57-$version/libE57Format/test"
echo "$folder"
