# A Ceph of one monitor, one disk (a file) and one gateway in the working folder, for a try and for tests; no store for
# use. A script takes these functions in with `.`: configured, then monitor, made, gateway; later monitor, gateway.
# shellcheck shell=sh
export CEPH_CONF=$PWD/ceph.conf

# configured GATEWAY_PORT MONITOR_PORT
configured() {
    fsid=$(cat /proc/sys/kernel/random/uuid)
    cat >ceph.conf <<END
[global]
fsid = $fsid
mon host = [v2:127.0.0.1:$2/0]
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
rgw frontends = beast endpoint=127.0.0.1:$1
rgw data = $PWD/rgw
rgw thread pool size = 16
END
    mkdir mon osd rgw
    monmaptool --create --fsid "$fsid" --addv a "[v2:127.0.0.1:$2]" monmap
    ceph-mon -i a --mkfs --monmap monmap
}

# What runs must not hold the input.
monitor() { ceph-mon -c "$CEPH_CONF" -i a -f </dev/null & monitor=$!; }

made() {
    disk_id=$(cat /proc/sys/kernel/random/uuid)
    ceph osd new "$disk_id"
    ceph-osd -i 0 --mkfs --osd-uuid "$disk_id"
}

# gateway GATEWAY_PORT
gateway() {
    ceph-osd -c "$CEPH_CONF" -i 0 -f </dev/null & disk=$!
    radosgw -c "$CEPH_CONF" -n client.rgw.a -f </dev/null & gateway=$!
    # An answer about a bucket comes from the disk.
    until curl --silent --max-time 2 --output /dev/null "http://127.0.0.1:$1/none/"; do sleep 0.1; done
}

# user NAME KEY_ID KEY, and more options
user() {
    name=$1 key_id=$2 key=$3
    shift 3
    radosgw-admin user create --uid="$name" --display-name="$name" --access-key="$key_id" --secret-key="$key" "$@"
}
