#!/bin/sh
# A user of an installed cdem who asks pkg-config for the flags.
#   pkg_config.sh COMPILER CDEM_SOURCE FOLDER PREFIX VERSION
set -eu
compiler=$1 source=$2 folder=$3 prefix=$4 version=$5
rm -rf "$folder"
mkdir -p "$folder"
export PKG_CONFIG_PATH="$prefix/share/pkgconfig${PKG_CONFIG_PATH:+:$PKG_CONFIG_PATH}"
[ "$(pkg-config --modversion cdem)" = "$version" ]
set -x
"$compiler" "$source/tests/consumer/main.cpp" $(pkg-config --cflags --libs cdem) -o "$folder/consumer"
"$folder/consumer"
