#!/bin/bash
# tools/gallery.sh MODELS: draws the pictures of docs/gallery.md up to "Where it fails" anew into docs/images and prints the figures that
# stand there (the others: tools/gallery_scans.sh). MODELS is
# a folder with the closed meshes lucy.ply, abc_00011084.ply, kitten.ply, nefertiti.ply and gears.ply (sources: end of that page). Every
# picture is made by the commands that are printed. The page itself, docs/images/page.png, needs Chromium.
set -euo pipefail
models=$(realpath "${1:?usage: tools/gallery.sh MODELS}")
cd "$(dirname "$0")/.."
. tools/prepare.sh
build release g3r_cli sample_cloud
images=$PWD/docs/images
PATH=$PWD/build/release/cli:$PWD/build/release/examples:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# The commands, shown before they run.
show() {
  echo "$ $*" | sed "s|$models/||; s|$images/||"
  "$@"
}

# solve NAME [FLAG...]: NAME.ply -> NAME.mesh.ply and NAME.oriented.ply, scored against NAME.truth.ply.
solve() {
  local name=$1
  shift
  show g3r "$name.ply" "$name.mesh.ply" --oriented "$name.oriented.ply" "$@"
  if [ -f "$name.truth.ply" ]; then show g3r eval "$name.oriented.ply" --truth "$name.truth.ply"; fi
}

# from MODEL NAME COUNT [FLAG...]: samples of a model as NAME.ply; their true normals are those of NAME.truth.ply.
from() {
  local model=$1 name=$2 count=$3
  shift 3
  show g3r sample "$models/$model.ply" "$name.ply" --count "$count" --seed 1 "$@"
  cp "$name.ply" "$name.truth.ply"
}

show sample_cloud cup.ply
solve cup
show g3r view cup.oriented.ply cup.mesh.ply --z-up --layers points,normals,mesh --tile 220 -o "$images/cup.png"

show g3r sample "$models/lucy.ply" back.xyz --count 50000 --seed 1
awk '/^[0-9-]/ { $1 = -$1; $2 = -$2; $4 = -$4; $5 = -$5 } { print }' back.xyz > lucy.xyz # turned, to see the face
show g3r lucy.xyz lucy.mesh.ply --oriented lucy.oriented.ply
show g3r eval lucy.oriented.ply --truth lucy.xyz
show g3r view lucy.oriented.ply lucy.mesh.ply --z-up --layers points,normals,mesh --views 1 --tile 400 -o "$images/lucy.png"

from abc_00011084 part 30000
solve part
show g3r view part.oriented.ply part.mesh.ply --layers points,normals,mesh --tile 220 -o "$images/cad.png"

from kitten noisy 30000 --noise 0.5%
solve noisy
show g3r view noisy.oriented.ply noisy.mesh.ply --layers points,normals,mesh --tile 220 -o "$images/noise.png"

show g3r sample "$models/nefertiti.ply" bust.xyz --count 30000 --seed 1
awk '/^[^0-9-]/ || !($1 > 0.25)' bust.xyz > open.xyz # the back was not scanned
show g3r open.xyz closed.ply --oriented open.ply
show g3r open.xyz trimmed.ply --open
show g3r view open.ply closed.ply --layers points,mesh --views 1 --tile 300 -o "$images/open.png"
show g3r view trimmed.ply --layers mesh --views 1 --tile 300 -o "$images/trimmed.png"

from gears gears 30000
solve gears
show g3r view gears.oriented.ply gears.mesh.ply --layers normals,confidence,mesh --tile 220 -o "$images/gears.png"

if command -v chromium > /dev/null; then
  from kitten kitten 30000
  solve kitten
  show g3r view kitten.oriented.ply kitten.mesh.ply --truth kitten.truth.ply -o look.html
  keys='<script>setTimeout(() => { for (const key of "2b") dispatchEvent(new KeyboardEvent("keydown", {key})); }, 3000);</script>'
  sed "s|</body>|$keys</body>|" look.html > pressed.html # outside and inside, compared with before
  chromium --headless=new --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader --hide-scrollbars \
    --window-size=1200,860 --virtual-time-budget=20000 --user-data-dir="$work/browser" --screenshot="$images/page.png" \
    "file://$work/pressed.html" > page.log 2>&1 || cat page.log >&2
fi
