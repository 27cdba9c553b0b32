#!/bin/sh
# CHOLMOD for compare.sh, from Debian's packages (as root).
set -eu
apt-get install -y gcc libsuitesparse-dev libopenblas-dev
