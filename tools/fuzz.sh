#!/bin/bash
# tools/fuzz.sh SECONDS [TARGET...]: fuzzes every reader, the command line and the whole pipeline (or the named ones) for so many seconds
# each, one process per core at a time, under ASan and UBSan (preset sanitize). Seeds: the short files of tests/badinputs and one small file
# of every format. Findings and what was learnt stay in build/fuzz/corpus. Exit status: 0 if there was no finding.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/prepare.sh
seconds=${1:?usage: tools/fuzz.sh SECONDS [TARGET...]}
shift
[ $# -gt 0 ] || set -- ply pcd npy las off obj stl gltf xyz command_line pipeline
build sanitize fuzz
programs=build/sanitize/fuzz
seeds=build/fuzz/seeds
corpora=build/fuzz/corpus
mkdir -p "$seeds/read" "$corpora"
python3 tests/badinputs/badinputs.py "$seeds/read" > /dev/null
find "$seeds/read" -type f -size +8 -delete # blocks of 512 bytes: short inputs run fast
"$programs/fuzz_seeds" "$seeds"

fuzz_one() {
  local corpus=$corpora/$1 from=$seeds/$1
  [ -d "$from" ] || from=$seeds/read
  mkdir -p "$corpus"
  "$programs/fuzz_$1" -max_total_time="$seconds" -timeout=30 -rss_limit_mb=2048 -max_len=4096 -print_final_stats=1 \
    -artifact_prefix="$corpus." "$corpus" "$from" > "$corpus.log" 2>&1
}

status=0
for target in "$@"; do
  while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do wait -n || true; done # a finding is told below
  fuzz_one "$target" &
done
wait
for target in "$@"; do
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$corpora/$target.log")
  findings=$(find "$corpora" -maxdepth 1 -name "$target.*-*" | wc -l)
  echo "$target: ${executions:-0} executions, $findings findings"
  if [ "$findings" -gt 0 ] || [ -z "$executions" ]; then
    tail -n 40 "$corpora/$target.log" >&2
    status=1
  fi
done
exit $status
