#!/bin/bash
# tools/laszip.sh DIR: fetches the sources of LASzip (Apache License 2.0) into DIR, for a build that reads LAZ:
#   tools/laszip.sh build/laszip && cmake --preset release -DG3R_LASZIP_SOURCE=build/laszip
# Debian 12 has no LASzip; they come from the source distribution of the package laszip on PyPI, of which only they are kept.
set -euo pipefail
folder=${1:?usage: tools/laszip.sh DIR}
version=0.3.0
sum=9ddf91649b519db308f63d772a19e7647458f5d5512e3d927629f0196b9c6216
if [ -e "$folder/src/lasreadpoint.cpp" ]; then exit 0; fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/environment"
pip=("$work/environment/bin/pip" --quiet --disable-pip-version-check --retries 1)
"${pip[@]}" install scikit-build-core pybind11 # pip asks the package's build system for its name before it hands it over
"${pip[@]}" download --no-deps --no-build-isolation --no-binary :all: --dest "$work" "laszip==$version"
echo "$sum  $work/laszip-$version.tar.gz" | sha256sum --check --quiet
mkdir -p "$folder"
tar -xzf "$work/laszip-$version.tar.gz" -C "$folder" --strip-components=4 --wildcards "laszip-$version/src/vendor/LASzip-*/*"
echo "$folder"
