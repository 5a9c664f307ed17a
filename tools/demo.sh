#!/bin/bash
# From a bare Debian 12 machine to a mesh: installs what is missing, builds g3r, makes a cloud of 50,000 points without normals (a cup
# on a saucer), reconstructs it and says where everything is. A second run only reconstructs.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/prepare.sh

prepare
build release g3r_cli sample_cloud

mkdir -p demo
build/release/examples/sample_cloud demo/cup.ply
echo
build/release/cli/g3r demo/cup.ply demo/cup.mesh.ply --report demo/cup.json
cat <<END

The cloud is in demo/cup.ply, the mesh in demo/cup.mesh.ply, the full report in demo/cup.json.
Your own: build/release/cli/g3r scan.ply        (build/release/cli/g3r --help says the rest)
END
