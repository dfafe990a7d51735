#!/bin/sh
# A Ceph of one monitor, one disk (a file) and one gateway: `ceph.sh FOLDER GATEWAY_PORT MONITOR_PORT`. It writes how
# often it has started to FOLDER/up each time it answers. For each line of its input all three are killed and started
# again, with what is on the disk; at the end of its input they are killed for good.
set -e
cd "$1"
export CEPH_CONF=$PWD/ceph.conf
fsid=$(cat /proc/sys/kernel/random/uuid)
disk=$(cat /proc/sys/kernel/random/uuid)
cat >ceph.conf <<END
[global]
fsid = $fsid
mon host = [v2:127.0.0.1:$3/0]
public addr = 127.0.0.1
cluster addr = 127.0.0.1
public network = 127.0.0.0/8
auth cluster required = none
auth service required = none
auth client required = none
ms mon client mode = crc
run dir = $PWD
admin socket = $PWD/\$name.asok
log file = $PWD/\$name.log
mon data = $PWD/mon
mon allow pool size one = true
mon data avail crit = 0
osd pool default size = 1
osd pool default min size = 1
osd pool default pg num = 1
osd pool default pg autoscale mode = off
osd crush chooseleaf type = 0
osd class update on start = false
osd data = $PWD/osd
osd objectstore = bluestore
osd memory target = 939524096
bluestore block size = 4294967296
bluestore block create = true
rgw frontends = beast endpoint=127.0.0.1:$2
rgw data = $PWD/rgw
rgw thread pool size = 16
END
mkdir mon osd rgw
monmaptool --create --fsid "$fsid" --addv a "[v2:127.0.0.1:$3]" monmap
ceph-mon -i a --mkfs --monmap monmap

# What runs must not hold the input.
monitor() { ceph-mon -i a -f </dev/null & monitor=$!; }
disk_and_gateway() {
    ceph-osd -i 0 -f </dev/null & osd=$!
    radosgw -n client.rgw.a -f </dev/null & gateway=$!
    # An answer about a bucket comes from the disk.
    until curl --silent --max-time 2 --output /dev/null "http://127.0.0.1:$port/none/"; do sleep 0.1; done
}
killed() { kill -9 "$monitor" "$osd" "$gateway" || true; wait; }
is_up() { echo "$1" >up.new && mv up.new up; }

port=$2
starts=1
monitor
ceph osd new "$disk"
ceph-osd -i 0 --mkfs --osd-uuid "$disk"
disk_and_gateway
radosgw-admin user create --uid=archive --display-name=archive --access-key=key --secret-key=word --caps='user-policy=*'
for station in booth-1 booth-2; do
    radosgw-admin user create --uid=$station --display-name=$station --access-key=$station --secret-key=word
done
is_up $starts
while read -r _; do
    killed
    monitor
    disk_and_gateway
    starts=$((starts + 1))
    is_up $starts
done
killed
