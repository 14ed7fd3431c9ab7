#!/bin/sh
# A user without CMake: the headers copied into a folder, two -I flags.
#   copied_headers.sh COMPILER CDEM_SOURCE FOLDER EIGEN_INCLUDE [FURTHER_INCLUDE ...]
set -eu
compiler=$1 source=$2 folder=$3
shift 3
rm -rf "$folder"
mkdir -p "$folder"
cp -r "$source/include" "$folder/include"
cp "$source/tests/consumer/main.cpp" "$folder"
cd "$folder"
flags="-Iinclude"
for directory in "$@"; do flags="$flags -I$directory"; done
set -x
"$compiler" -std=c++20 -pthread $flags main.cpp -o consumer
./consumer
