#!/bin/bash
# tools/check.sh [--fix] [format] [spelling] [tidy]: what is checked without running anything; by default all three. With --fix, sources are
# formatted, and misspellings that have one correction are corrected.
#   format    clang-format has nothing to change in any source.
#   spelling  codespell (from PyPI, into build/check-environment the first time) knows no word of the sources and pages as a misspelling.
#   tidy      clang-tidy has nothing to say of the sources that differ from BASE (by default where this branch left origin/main or main, or
#             the commit before, on main itself), compiled as in build/sanitize, but each by itself. Of a large change it takes the sources
#             that changed most.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/prepare.sh
most_tidied=12 # half a minute each on a slow core: more would take longer than the tests
codespell=2.4.3
database=build/check-tidy # how sources are compiled; nothing is built there
# Sources of other systems, of other options and of other projects, which that build does not have.
elsewhere='_windows\.cpp$|^src/(cpu/parallel_serial|gpu/library_none|io/float_text_c|mesh/screened_poisson)\.cpp$'
elsewhere+='|^tests/(consumer/.*|guest_test|together_main)\.cpp$'

fix=
if [ "${1:-}" = --fix ]; then
  fix=1
  shift
fi
[ $# -gt 0 ] || set -- format spelling tidy

check_format() {
  local sources
  mapfile -t sources < <(git ls-files '*.cpp' '*.h')
  if [ -n "$fix" ]; then
    clang-format -i "${sources[@]}"
  elif ! clang-format --dry-run -Werror "${sources[@]}"; then
    echo "these sources are not formatted: run tools/check.sh --fix format" >&2
    return 1
  fi
  echo "format: ${#sources[@]} sources"
}

check_spelling() {
  local environment=build/check-environment texts
  if [ "$("$environment/bin/codespell" --version 2> /dev/null)" != "$codespell" ]; then
    python3 -m venv --clear "$environment"
    "$environment/bin/pip" install --quiet --disable-pip-version-check "codespell==$codespell"
  fi
  mapfile -t texts < <(git ls-files | grep -vE '\.(png|svg|ply|xyz|json|bib|ipynb)$|^docs/(images|results)/')
  # Words of ours that are misspellings of another: axes (normalY), constants (kOwn, kNo), tests, parts of formulas (nd) and file names (fo).
  "$environment/bin/codespell" ${fix:+--write-changes} --ignore-words-list normaly,kown,nd,fo,kno,wallthickness,infinit,hart "${texts[@]}"
  echo "spelling: ${#texts[@]} files"
}

# base: the commit that this branch is compared with; empty if the history ends here.
base() {
  local main
  for main in "${BASE:-}" origin/main main; do
    if [ -n "$main" ] && git rev-parse --quiet --verify "$main^{commit}" > /dev/null; then
      main=$(git merge-base "$main" HEAD || true)
      if [ -n "$main" ] && [ "$main" != "$(git rev-parse HEAD)" ]; then
        echo "$main"
        return
      fi
    fi
  done
  git rev-parse --quiet --verify 'HEAD~1^{commit}' || true
}

# changed_sources BASE: the sources that differ from the commit or whose header does, the most changed first.
changed_sources() {
  git diff --numstat --diff-filter=d "$1" -- '*.cpp' '*.h' | sort -k1,1nr -k3 | cut -f3 | sed 's/\.h$/.cpp/' | awk '!seen[$0]++' |
    while read -r source; do
      if [ -e "$source" ]; then echo "$source"; fi
    done
}

# is_compiled SOURCE: whether the build has it.
is_compiled() { grep -qF "\"file\": \"$PWD/$1\"" "$database/compile_commands.json"; }

check_tidy() {
  local commit source sources=() left_out=() unknown=()
  commit=$(base)
  if [ -z "$commit" ]; then
    echo "tidy: left out, as there is no history to compare with"
    return
  fi
  cmake --preset sanitize -B "$database" -DG3R_TOGETHER=OFF -DG3R_PRECOMPILE=OFF --log-level=WARNING > /dev/null
  while read -r source; do
    if is_compiled "$source"; then
      sources+=("$source")
    elif [[ $source =~ ^(src|cli|tests)/ && ! $source =~ $elsewhere ]]; then
      unknown+=("$source")
    else
      left_out+=("$source")
    fi
  done < <(changed_sources "$commit")
  if [ ${#unknown[@]} -gt 0 ]; then
    echo "tidy: no build has these sources, so that they cannot be checked: ${unknown[*]}" >&2
    return 1
  fi
  if [ ${#left_out[@]} -gt 0 ]; then echo "tidy: of other builds, left out: ${left_out[*]}"; fi
  if [ ${#sources[@]} -gt $most_tidied ]; then
    echo "tidy: ${#sources[@]} sources differ from ${commit:0:12}; these are left out: ${sources[*]:$most_tidied}"
    sources=("${sources[@]:0:$most_tidied}")
  fi
  if [ ${#sources[@]} -gt 0 ]; then
    printf '%s\0' "${sources[@]}" | xargs -0 -n 1 -P "$(nproc)" clang-tidy --quiet -p "$database"
  fi
  echo "tidy: ${#sources[@]} sources"
}

for check in "$@"; do
  case $check in
    format | spelling | tidy) "check_$check" ;;
    *) echo "tools/check.sh: no check is called $check: format, spelling, tidy" >&2 && exit 64 ;;
  esac
done
