#!/bin/sh
# The Ceph of a try, for tests: `ceph.sh FOLDER GATEWAY_PORT MONITOR_PORT`. It writes how often it has started to
# FOLDER/up each time it answers. For each line of its input all three are killed and started again, with what is on
# the disk; at the end of its input they are killed for good.
set -e
scripts=$(cd "$(dirname "$0")/../../../../systemd/archive" && pwd)
cd "$1"
. "$scripts/ceph.sh"

killed() { kill -9 "$monitor" "$disk" "$gateway" || true; wait; }
is_up() { echo "$1" >up.new && mv up.new up; }

starts=1
configured "$2" "$3"
monitor
made
gateway "$2"
user archive key word --caps='user-policy=*'
for station in booth-1 booth-2; do user $station $station word; done
is_up $starts
while read -r _; do
    killed
    monitor
    gateway "$2"
    starts=$((starts + 1))
    is_up $starts
done
killed
