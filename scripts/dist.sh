#!/bin/sh
# SPDX-License-Identifier: MIT
# dist.sh VERSION STAMP FILE.ptx...: the release archive of the last commit, build/dist/brisance-VERSION.tar.gz.
#
# It holds the sources, ptx/ with the GPU code of these sources (scripts/gpu_build.py takes it where
# flang-22 is missing), and COMMIT, the name of the commit (scripts/version.py reads it outside git).
set -eu
version=$1 stamp=$2
shift 2
root=brisance-$version
archive=build/dist/$root.tar.gz
commit=$(git describe --always --abbrev=12 --exclude='*')
mkdir -p build/dist
echo "$commit" > build/dist/COMMIT
for ptx; do
    [ "$(head -n 1 "$ptx")" = "// $stamp" ] || { echo "dist: $ptx is of other sources: run make gpu" >&2; exit 1; }
    set -- "$@" "--add-file=$ptx"
    shift
done
git archive --format=tar.gz --output="$archive" --prefix="$root/ptx/" "$@" \
    --prefix="$root/" --add-file=build/dist/COMMIT HEAD
echo "$archive: commit $commit with GPU code $stamp"
