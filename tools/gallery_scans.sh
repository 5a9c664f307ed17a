#!/bin/bash
# tools/gallery_scans.sh MODELS: draws the pictures of docs/gallery.md from "Outliers" on anew into docs/images, by the commands that it
# prints with what g3r said. MODELS is a folder with kitten.ply. Needs NumPy, SciPy and Pillow (bench/README.md).
set -euo pipefail
models=$(realpath "${1:?usage: tools/gallery_scans.sh MODELS}")
cd "$(dirname "$0")/.."
. tools/prepare.sh
build release g3r_cli
images=$PWD/docs/images
bench=$PWD/bench
PATH=$PWD/build/release/cli:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# The commands, shown before they run.
show() {
  echo "$ $*" | sed "s|$models/||; s|$bench/|bench/|"
  "$@"
}

# mesh NAME CLOUD [FLAG...]: CLOUD.ply -> NAME.mesh.ply, NAME.oriented.ply.
mesh() {
  local name=$1 cloud=$2
  shift 2
  show g3r "$cloud.ply" "$name.mesh.ply" --oriented "$name.oriented.ply" "$@"
}

# pictures OUT HEADS UP CLOUD NAME...: the points of the cloud, and the meshes of these names, side by side. UP: y or z.
pictures() {
  local out=$1 heads=$2 up=$3 cloud=$4
  shift 4
  local turned=() files=$cloud.points.png name
  if [ "$up" = z ]; then turned=(--z-up); fi
  g3r view "$cloud.ply" --layers points --tile "$tile" "${turned[@]}" -q -o "$cloud.points.png"
  for name in "$@"; do
    g3r view "$name.mesh.ply" --layers mesh --tile "$tile" "${turned[@]}" -q -o "$name.png"
    files=$files,$name.png
  done
  python3 "$bench/montage.py" "$images/$out.png" --heads "$heads" --tile "$tile" --colours 160 "$cloud=$files"
}
tile=280

show g3r sample "$models/kitten.ply" dense.ply --count 400000 --seed 1
show python3 "$bench/corrupt.py" dense.ply outliers.ply --count 60000 --uneven 1 --outliers 0.2
mesh all outliers --keep-all
mesh outliers outliers
pictures scan-outliers "points,--keep-all,no flag" y outliers all outliers

show python3 "$bench/scans.py" house house.ply
mesh all house --keep-all
mesh house house
mesh open house --open
pictures scan-house "points,--keep-all,no flag,--open" z house all house open

show python3 "$bench/scans.py" plate plate.ply
mesh plate plate
pictures scan-plate "points,no flag" z plate plate

show python3 "$bench/scans.py" frame frame.ply
mesh frame frame
mesh seen frame --open
pictures scan-frame "points,no flag,--open" y frame frame seen

show python3 "$bench/scans.py" arch arch.ply
mesh arch arch
mesh open arch --open
pictures scan-arch "points,no flag,--open" z arch arch open

show python3 "$bench/scans.py" airborne airborne.ply
mesh airborne airborne
mesh open airborne --up +z --open
pictures scan-airborne "points,no flag,--up +z --open" z airborne airborne open

show python3 "$bench/scans.py" lines lines.ply
mesh lines lines
mesh open lines --up +z --open
pictures scan-lines "points,no flag,--up +z --open" z lines lines open

for kind in wires slices; do
  show python3 "$bench/scans.py" $kind $kind.ply
  mesh $kind $kind
  pictures scan-$kind "points,no flag" z $kind $kind
done

show python3 "$bench/scans.py" room room.ply
mesh room room
mesh inside room --seen-from-inside
for name in room inside; do # without the ceiling
  g3r view $name.oriented.ply --box=-1,-1,-1,7,6,2.6 --layers normals --z-up --tile $tile -q -o $name.png
done
python3 "$bench/montage.py" "$images/scan-room.png" --heads "no flag,--seen-from-inside" --tile $tile --colours 160 room=room.png,inside.png

show python3 "$bench/scans.py" table table.ply
mesh table table
mesh open table --up +z --open
pictures scan-table "points,no flag,--up +z --open" z table table open

show python3 "$bench/splats.py" make dense.ply splats.ply --count 30000
mesh all splats --all-splats
mesh splats splats
pictures scan-splats "centres,--all-splats,no flag" y splats all splats

show g3r sample "$models/kitten.ply" sparse.ply --count 500 --seed 1
mesh sparse sparse
pictures scan-sparse "points,no flag" y sparse sparse
