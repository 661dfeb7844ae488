#!/bin/sh
# SPDX-License-Identifier: MIT
# Install what is missing: packages of scripts/packages.txt, and .venv after requirements.txt.
# Does nothing, quickly, when nothing is missing. Needs root or sudo only to install packages.
set -eu
cd "$(dirname "$0")/.."
list=scripts/packages.txt
say() { echo "setup: $*" >&2; }

missing_of() { # those of the packages $* that are not installed
    for name in $*; do
        case "$installed" in *" $name "*) ;; *) printf '%s ' "$name" ;; esac
    done
}

needed=$(sed -n 's/^\([a-z][^ ?]*\).*/\1/p' $list)
optional=$(sed -n 's/^?\([^ ]*\).*/\1/p' $list)
if ! command -v dpkg-query >/dev/null; then
    for tool in gfortran h5fc pkg-config; do
        command -v $tool >/dev/null && continue
        say "this is no Debian or Ubuntu. Install what these packages hold: $needed"
        exit 1
    done
    needed= optional= installed=
else
    installed=" $(dpkg-query -W -f='${db:Status-Status} ${Package}\n' $needed $optional 2>/dev/null |
        sed -n 's/^installed //p' | tr '\n' ' ')"
fi
missing=$(missing_of $needed)
case "$missing" in
*python3-venv*)
    if [ -x .venv/bin/python ] || python3 -c 'import ensurepip' 2>/dev/null; then
        missing=$(echo "$missing" | sed 's/python3-venv//')
    fi ;;
esac
missing=$(echo $missing)
extra=$(missing_of $optional)
available() { # those of $* that can be installed
    for name in $*; do
        apt-cache policy "$name" 2>/dev/null | grep -q 'Candidate: [0-9]' && printf '%s ' "$name"
    done
    true
}
[ -n "$missing" ] || extra=$(available $extra)

if [ -n "$missing$extra" ]; then
    if [ "$(id -u)" = 0 ]; then
        root=
    elif sudo -n true 2>/dev/null; then
        root=sudo
    elif [ -n "$missing" ]; then
        say "these packages are missing: $missing"
        say "run this once, then try again:"
        echo "    sudo apt-get update && sudo apt-get install -y --no-install-recommends $missing"
        [ -z "$extra" ] || say "and, if you like, for the GPU (Debian 12) and the site of the documentation: $extra"
        exit 1
    else
        say "optional, not installed: $extra"
        extra=
    fi
fi
if [ -n "$missing$extra" ]; then
    export DEBIAN_FRONTEND=noninteractive
    say "installing packages: $missing $extra"
    $root apt-get update -qq
    extra=$(available $extra)
    $root apt-get install -y -qq --no-install-recommends $missing $extra >/dev/null ||
        { say "apt-get failed"; exit 1; }
fi

if ! cmp -s requirements.txt .venv/requirements.txt; then
    python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
        { say "Python 3.11 or newer is needed"; exit 1; }
    say "installing Python packages into .venv"
    [ -x .venv/bin/python ] || python3 -m venv .venv
    .venv/bin/python -m pip install -q --disable-pip-version-check -r requirements.txt ||
        { say "pip failed: it needs the network once"; exit 1; }
    cp requirements.txt .venv/requirements.txt
fi
