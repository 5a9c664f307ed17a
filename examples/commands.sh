#!/bin/sh
# Every command of the program once, in an empty folder: a cloud is sampled from a mesh, oriented, scored, meshed, scored again and shown.
# usage: commands.sh CLOUD   (any file of points without normals; g3r is found on the PATH)
set -eu

g3r info "$1"
g3r "$1" first.ply --report first.json                 # points -> closed mesh
g3r sample first.ply truth.ply --count 5000 --seed 1   # points on that mesh, with its normals: something to compare with
g3r orient truth.ply oriented.ply                      # the normals in the file are not looked at
g3r eval oriented.ply --truth truth.ply                # scores of the normals
g3r mesh oriented.ply second.ply --keep-largest 1      # points with normals -> mesh
g3r eval second.ply --truth first.ply --samples 20000  # scores of the mesh
g3r view oriented.ply second.ply -o look.html          # one page for the browser
g3r view second.ply -o look.png --tile 300             # four views
ls -l
