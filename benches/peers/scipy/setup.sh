#!/bin/sh
# SciPy in a virtual environment. Usage: setup.sh FOLDER, then: . FOLDER/bin/activate
set -eu
folder=${1:?folder for the virtual environment, outside the repository}
python3 -m venv "$folder"
"$folder/bin/pip" install --quiet scipy==1.17.1 numpy==2.4.6
"$folder/bin/python" -c 'import scipy; print("SciPy", scipy.__version__)'
