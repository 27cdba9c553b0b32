#!/bin/sh
# jax-md in a virtual environment, as used by fire_speed.py. Usage: setup.sh FOLDER, then: . FOLDER/bin/activate
set -eu
folder=${1:?folder for the virtual environment, outside the repository}
python3 -m venv "$folder"
"$folder/bin/pip" install --quiet jax-md==0.2.29 jax==0.10.2
"$folder/bin/python" -c 'import jax, jax_md; print("jax", jax.__version__, "on", jax.devices())'
