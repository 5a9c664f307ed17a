#!/bin/bash
# Checks the documentation (tools/check_docs.py), builds its site into build/site and checks that. mkdocs-material comes from PyPI the
# first time; after that no network is used, and the pages never use any.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/prepare.sh
python3 -B tools/check_docs.py

environment=build/site-environment
if [ ! -x $environment/bin/mkdocs ]; then
  python3 -m venv --clear $environment
  $environment/bin/pip install --quiet --disable-pip-version-check 'mkdocs>=1.6,<2' 'mkdocs-material>=9.5,<10'
fi
NO_MKDOCS_2_WARNING=1 $environment/bin/mkdocs build --strict --quiet
if grep -rlE '<(script|link|img|iframe)[^>]+(src|href)="?(https?:)?//' --include=*.html build/site; then
  echo "these pages load something from the network" >&2
  exit 1
fi
echo "build/site/index.html"
