#!/bin/bash
# tools/reproducible.sh [TARGET...]: builds the targets (by default the program and the shared library) twice, in two folders whose names
# differ in length, without a compiler cache, and compares every object, archive, library and program. Exit status 1 if any differs.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || set -- g3r_cli g3r_shared
. tools/prepare.sh
tools/sources.sh || true
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset CMAKE_CXX_COMPILER_LAUNCHER CMAKE_C_COMPILER_LAUNCHER
export CCACHE_DISABLE=1

# results FOLDER: checksums of what was built in it, with names that do not depend on the folder.
results() {
  (cd "$1/build/release" && find . -type f \( -name '*.o' -o -name '*.a' -o -name '*.so.*' -o -path './cli/g3r' \) -print0 | sort -z | xargs -0 sha256sum)
}

for folder in one another_with_a_longer_name; do
  mkdir -p "$work/$folder/build"
  git ls-files -z | tar --null --files-from=- -c | tar -x -C "$work/$folder"
  if [ -d build/sources ]; then cp -r build/sources "$work/$folder/build/"; fi
  (cd "$work/$folder" && build release "$@") > "$work/log" 2>&1 || { tail -n 20 "$work/log" >&2; exit 1; }
  results "$work/$folder" > "$work/$folder.sums"
done
count=$(wc -l < "$work/one.sums")
if ! diff "$work/one.sums" "$work/another_with_a_longer_name.sums"; then
  echo "these files depend on the folder that they are built in" >&2
  exit 1
fi
echo "the same bytes in both folders: $count files"
