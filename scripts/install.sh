#!/bin/sh
# SPDX-License-Identifier: MIT
# install.sh PROGRAM NAME STAMP PREFIX [DESTDIR]: what `make install` does.
#
#   PREFIX/bin/NAME                       the program; presets are built into it
#   PREFIX/bin/brisance-post              the Python tools, by $BRISANCE_PYTHON or python3
#   PREFIX/lib/brisance/NAME.ptx          the GPU code, where `make gpu` has made it; NAME finds it
#   PREFIX/share/brisance                 post/, inputs/ (with presets/), requirements.txt
#
# DESTDIR goes before PREFIX while a package is made. Nothing installed knows PREFIX: the tree may move.
set -eu
cd "$(dirname "$0")/.."
program=$1 name=$2 stamp=$3 prefix=${5:-}$4
bin=$prefix/bin lib=$prefix/lib/brisance share=$prefix/share/brisance
mkdir -p "$bin" "$lib" "$share"
install -m 755 "$program" "$bin/$name"
if [ "$(head -n 1 "$program.ptx" 2>/dev/null)" = "// $stamp" ]; then
    install -m 644 "$program.ptx" "$lib/$name.ptx"
else
    rm -f "$lib/$name.ptx"
    echo "install: without GPU code: run make gpu first, with the same PRECISION and PORTABLE"
fi
rm -rf "$share/post" "$share/inputs"
cp -R inputs "$share/inputs"
mkdir "$share/post"
tar cf - --exclude=__pycache__ post | tar xf - -C "$share"
sed '/^# tests/,$d' requirements.txt > "$share/requirements.txt"
cat > "$bin/brisance-post" <<'END'
#!/bin/sh
# The Python tools of Brisance, by $BRISANCE_PYTHON or python3.
share=$(dirname "$(readlink -f "$0")")/../share/brisance
python=${BRISANCE_PYTHON:-python3}
"$python" -c 'import f90nml, h5py, matplotlib, pyvista' 2>/dev/null || {
    echo "brisance-post: $python lacks what it needs: $python -m pip install -r $(realpath "$share")/requirements.txt" >&2
    exit 1
}
PYTHONPATH=$share${PYTHONPATH:+:$PYTHONPATH} exec "$python" -c '
import sys
from post.__main__ import main
sys.argv[0] = "brisance-post"
sys.exit(main())' "$@"
END
chmod 755 "$bin/brisance-post"
echo "install: $bin/$name, $bin/brisance-post, $lib, $share"
