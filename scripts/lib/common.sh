# Shared by quickstart and test: messages, and the packages of Debian and Ubuntu that a command needs.
# To be sourced by a bash script that has set -euo pipefail.

export LC_ALL=C
JOBS=$(nproc 2>/dev/null || echo 2)

say() { printf '%s\n' "$*"; }

# fail <what went wrong> <what to do>: ends the script.
fail() {
  printf '\nFailed: %s\n%s\n' "$1" "$2" >&2
  exit 1
}

# quietly <log> <command...>: runs the command with its output in the log, whose end is shown if it fails.
quietly() {
  local log=$1
  shift
  mkdir -p "$(dirname "$log")"
  "$@" >"$log" 2>&1 || { tail -n 25 "$log" >&2; return 1; }
}

is_installed() { [ "$(dpkg-query -W -f='${db:Status-Abbrev}' "$1" 2>/dev/null)" = "ii " ]; }

# require_packages <package | command=package>...: installs those that are missing, all at once. A word with '='
# counts as present when the command is there, whoever installed it.
require_packages() {
  local word missing=()
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    say "This is not Debian or Ubuntu: the following, under the names of your system, must be installed by you:"
    say "  ${*/*=/}"
    say "CMake fetches the libraries that it does not find."
    return 0
  fi
  for word in "$@"; do
    if [[ $word == *=* ]] && command -v "${word%%=*}" >/dev/null; then continue; fi
    is_installed "${word#*=}" || missing+=("${word#*=}")
  done
  [ ${#missing[@]} -gt 0 ] || return 0

  local root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      say "Missing, and neither root nor sudo to install them: ${missing[*]}"
      say "  as root: apt-get install --no-install-recommends ${missing[*]}"
      say "Going on with what is there; CMake fetches the libraries that it does not find."
      return 0
    fi
    root=(sudo)
  fi
  say "Installing ${missing[*]}"
  local install=("${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends "${missing[@]}")
  # Package lists that are there may do; where they are absent or stale, fetch them and try again.
  quietly "$LOGS/install.log" "${install[@]}" 2>/dev/null && return 0
  quietly "$LOGS/apt-update.log" "${root[@]}" apt-get update ||
    fail "apt-get update (see $LOGS/apt-update.log)" "Check the network and /etc/apt/sources.list, then run this again."
  quietly "$LOGS/install.log" "${install[@]}" ||
    fail "apt-get install (see $LOGS/install.log)" "Install by hand: ${missing[*]}"
}
