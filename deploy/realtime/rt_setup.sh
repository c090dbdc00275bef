#!/usr/bin/env bash
# Lets people run Tact sessions in real time without being root: group tact, limits, /dev/cpu_dma_latency. Idempotent.
#   rt_setup.sh [USER...]       as root; adds USER (default: whoever called sudo) to the group
#   rt_setup.sh --dry-run       prints what it would do
#   rt_setup.sh --remove        takes the limits and the rule away again; the group stays
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
limits=/etc/security/limits.d/60-tact.conf
rule=/etc/udev/rules.d/60-tact.rules

dry_run='' remove=''
while [[ "${1:-}" == -* ]]; do
  case "$1" in
    -h | --help) sed -n '2,5s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --dry-run) dry_run=yes ;;
    --remove) remove=yes ;;
    *) echo "rt_setup.sh: unknown option '$1' (known: --dry-run, --remove)" >&2; exit 2 ;;
  esac
  shift
done
if [[ -z $dry_run && $EUID -ne 0 ]]; then
  echo "rt_setup.sh: needs root: sudo $0 $*" >&2
  exit 1
fi

do_it() { if [[ -n $dry_run ]]; then printf '%s\n' "$*"; else "$@"; fi; }

if [[ -n $remove ]]; then
  do_it rm -f "$limits" "$rule"
else
  getent group tact >/dev/null || do_it groupadd --system tact
  do_it install -D -m 0644 "$here/limits.conf" "$limits"
  do_it install -D -m 0644 "$here/60-tact.rules" "$rule"
  users=("$@")
  ((${#users[@]})) || users=(${SUDO_USER:-})
  for user in "${users[@]}"; do do_it usermod -a -G tact "$user"; done
fi
# Containers have no udev daemon; the rule then counts from the next boot of a machine that has one.
if command -v udevadm >/dev/null; then
  do_it udevadm control --reload || true
  do_it udevadm trigger --name-match=cpu_dma_latency || true
fi
if [[ -z $remove ]]; then echo "Log out and in again, then: tact doctor"; fi
