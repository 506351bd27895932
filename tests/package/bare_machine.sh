#!/usr/bin/env bash
# bare_machine.sh SUITE FOLDER — tries the packages in output/packages on a bare Debian SUITE (bookworm, trixie), as root.
#
# Makes the machine in FOLDER by debootstrap where there is none (some 300 MB from the registry, and what the packages need), installs
# both packages there by apt-get, runs `lensproof demo`, and builds and runs tests/package/uses_engine. Not part of the
# gate: it takes minutes and the registry.
set -euo pipefail
source=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
suite=$1 machine=$2

[[ -d $machine/bin ]] || debootstrap --variant=minbase "$suite" "$machine"
trap 'umount -q "$machine/proc" "$machine/dev" || true' EXIT
mount -t proc proc "$machine/proc"
mount --bind /dev "$machine/dev"
cp /etc/resolv.conf /etc/hosts "$machine/etc/"
cp "$source"/output/packages/*.deb "$machine/tmp/"
cp -r "$source/tests/package/uses_engine" "$machine/tmp/"

inside() { chroot "$machine" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive HOME=/root "$@"; }
inside apt-get -q update
inside sh -c 'apt-get -q -y install --no-install-recommends /tmp/lensproof_*.deb'
inside lensproof --version
inside sh -c 'cd /root && lensproof demo'
inside sh -c 'apt-get -q -y install --no-install-recommends /tmp/liblensproof-dev_*.deb g++ cmake make'
inside sh -c 'cd /tmp/uses_engine && cmake -B build && cmake --build build && build/uses_engine'
