#!/bin/bash
# tools/measure.sh DATA [OPTION...]: measures the tables of the documentation on the meshes in the folder DATA (28 models; hours on two
# cores), writes them to docs/results, where they take the place of earlier ones, and into the pages.
#   --parts clean,noise   normals of clean and of noisy samples (the default), and meshes, beside screened Poisson (G3R_WITH_OPEN3D)
#   --models a,b          only these models; what comes out stays in build/measure/results
#   --threads N           all cores by default
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/prepare.sh

usage() {
  sed -n '2,6s/^# \{0,1\}//p' "$0" >&2
  exit 64
}

data=${1:-}
[ -d "$data" ] || usage
shift
parts=clean,noise
out=docs/results
limits=()
while [ $# -ge 2 ]; do
  case $1 in
    --parts) parts=$2 ;;
    --models) limits+=(--models "$2") out=build/measure/results ;;
    --threads) limits+=(--threads "$2") ;;
    *) usage ;;
  esac
  shift 2
done
[ $# -eq 0 ] || usage
if ! git diff --quiet HEAD -- CMakeLists.txt cmake include src bench; then
  echo "commit the sources first: the results are labelled with the commit" >&2
  exit 1
fi
label=$(git rev-parse --short=7 HEAD)
work=build/measure
mkdir -p $work "$out"
build release g3r_bench_table

# table NAME OPTION...: one run of g3r_bench_table.
table() {
  build/release/bench/g3r_bench_table --data "$data" --label "$label" --json $work/"$1".json --markdown $work/"$1".md \
    ${limits[@]+"${limits[@]}"} "${@:2}"
}

measure_clean() {
  table clean --points 5000,50000 --method default --method wnnc --method "wnnc;widths=clean" --method agr --method pgr --method paper
  python3 -B bench/summary.py reduce $work/clean.json -o "$out"/clean.json
}

measure_noise() {
  table noise-0.25 --points 50000 --inputs noise:0.25 --method default --method ceiling --method "wnnc;widths=noise-0.25"
  table noise-0.5 --points 50000 --inputs noise:0.5 --method default --method ceiling --method "wnnc;widths=noise-0.5"
  python3 -B bench/summary.py reduce $work/noise-0.25.json $work/noise-0.5.json -o "$out"/noise.json
}

measure_meshes() {
  local poisson=";mesher=poisson;depth=10"
  table meshes --points 50000 --inputs clean,noise:0.5 --mesh --method default --method "default$poisson"
  table meshes-true --points 50000 --mesh --method true --method "true$poisson"
  python3 -B bench/summary.py reduce --meshes-only $work/meshes.json $work/meshes-true.json -o "$out"/meshes.json
}

for part in ${parts//,/ }; do
  case $part in
    clean | noise | meshes) measure_"$part" ;;
    *) usage ;;
  esac
done
if [ $out = docs/results ]; then python3 -B bench/summary.py tables; fi
echo "$out"
