#!/bin/bash
# tools/fuzz.sh SECONDS [TARGET...]: fuzzes every reader, the command line and the whole pipeline (or the named ones) for so many seconds
# each, one process per core at a time, under ASan and UBSan (preset sanitize). Seeds: the short files of tests/badinputs and one small file
# of every format. Findings and what was learnt stay in build/fuzz/corpus. Exit status: 0 if there was no finding.
# FUZZ_SEED=N in the environment makes a run that can be repeated: the same inputs in the same order, as far as the time allows, whatever
# earlier runs have learnt. Without it every run is another one.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/prepare.sh
seconds=${1:?usage: tools/fuzz.sh SECONDS [TARGET...]}
shift
build sanitize fuzz
programs=build/sanitize/fuzz
if [ $# -eq 0 ]; then
  set -- ply pcd npy las off obj stl gltf xyz ptx grid spz streams folders command_line pipeline
  for reader in laz e57; do # where build/sanitize is configured to read them
    [ ! -e "$programs/fuzz_$reader" ] || set -- "$@" $reader
  done
fi
seeds=build/fuzz/seeds
corpora=build/fuzz/corpus
mkdir -p "$seeds/read" "$corpora"
python3 tests/badinputs/badinputs.py "$seeds/read" > /dev/null
find "$seeds/read" -type f -size +8 -delete # blocks of 512 bytes: short inputs run fast
"$programs/fuzz_seeds" "$seeds"

fuzz_one() {
  local corpus=$corpora/$1 from=$seeds/$1
  [ -d "$from" ] || from=$seeds/read
  local start=("$corpus" "$from") run=()
  if [ -n "${FUZZ_SEED:-}" ]; then
    # Folders are read in any order, so the seeds are named; an empty folder takes what is learnt. What is learnt from comparisons holds
    # addresses, which differ from run to run.
    run=(setarch --addr-no-randomize)
    "${run[@]}" true 2> /dev/null || run=() # some containers forbid it
    rm -rf "$corpus.repeatable"
    mkdir -p "$corpus.repeatable"
    find "$from" -type f | LC_ALL=C sort | paste -sd, > "$corpus.seeds"
    start=(-seed="$FUZZ_SEED" -reload=0 -use_cmp=0 -seed_inputs=@"$corpus.seeds" "$corpus.repeatable")
  else
    mkdir -p "$corpus"
  fi
  local length=4096
  [ "$1" != e57 ] || length=8192 # the shortest have 3 pages of 1024
  "${run[@]}" "$programs/fuzz_$1" -max_total_time="$seconds" -timeout=120 -report_slow_units=120 \
    -rss_limit_mb=2048 -max_len="$length" -print_final_stats=1 \
    -artifact_prefix="$corpus." "${start[@]}" > "$corpus.log" 2>&1
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
