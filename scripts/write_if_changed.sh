#!/bin/sh
# SPDX-License-Identifier: MIT
# write_if_changed.sh FILE: copy standard input to FILE, but leave FILE alone if it is the same.
new="$1.new.$$"
mkdir -p "$(dirname "$1")"
cat > "$new"
if cmp -s "$new" "$1"; then rm -f "$new"; else mv "$new" "$1"; fi
