#!/bin/sh
# tools/fuzz.sh SECONDS [READER...]: fuzzes every reader (or the named ones) for so many seconds each, one process per core at a time.
# Seeds: the short files of tests/badinputs and one small file of every format. Findings and what was learnt stay in build/fuzz/corpus.
# Exit status: 0 if there was no finding.
set -eu
cd "$(dirname "$0")/.."
seconds=${1:?usage: tools/fuzz.sh SECONDS [READER...]}
shift
[ $# -gt 0 ] || set -- ply pcd npy las off obj stl gltf xyz
build=build/fuzz
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=clang++ -DG3R_BUILD_FUZZ=ON -DG3R_BUILD_TESTS=OFF \
  -DG3R_BUILD_BENCH=OFF -DG3R_BUILD_CLI=OFF -DG3R_BUILD_EXAMPLES=OFF -DG3R_WITH_OPEN3D=OFF > "$build.log" 2>&1 || { cat "$build.log" >&2; exit 1; }
cmake --build "$build" --target fuzz

seeds=$build/seeds
mkdir -p "$seeds"
python3 tests/badinputs/badinputs.py "$seeds" > /dev/null
find "$seeds" -size +8 -delete # blocks of 512 bytes: short inputs run fast
"$build/fuzz/fuzz_seeds" "$seeds"

fuzz_one() {
  corpus=$build/corpus/$1
  mkdir -p "$corpus"
  "$build/fuzz/fuzz_$1" -max_total_time="$seconds" -timeout=2 -rss_limit_mb=2048 -max_len=4096 -print_final_stats=1 \
    -artifact_prefix="$corpus." "$corpus" "$seeds" > "$corpus.log" 2>&1
}

status=0
running=0
cores=$(nproc)
for reader in "$@"; do
  fuzz_one "$reader" &
  eval "pid_$reader=$!"
  running=$((running + 1))
  if [ "$running" -ge "$cores" ]; then
    wait
    running=0
  fi
done
for reader in "$@"; do
  eval "wait \$pid_$reader" || status=1
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/corpus/$reader.log")
  findings=$(find "$build/corpus" -maxdepth 1 -name "$reader.*-*" | wc -l)
  echo "$reader: ${executions:-0} executions, $findings findings"
  [ "$findings" -eq 0 ] && [ -n "$executions" ] || status=1
done
exit $status
