#!/bin/sh
# Makes the demo's certificates, once a year: an authority, and a folder for each program on a volume of its own.
# The authority's secret goes with this container: nobody can be added later, and others mean a new authority.
set -eu
recent=$(find /keys/netem/cert.pem /keys/robot/cert.pem /keys/operator/cert.pem -mtime -300 2>/dev/null | wc -l)
if [ "$recent" = 3 ]; then
    echo "keys: there already"
    exit 0
fi
authority=/tmp/authority
farhand="python -m farhand"
$farhand certs init --dir $authority >/dev/null
$farhand certs issue netem gate --host netem-operator --host netem-robot --dir $authority >/dev/null
$farhand certs issue robot ur5 --dir $authority >/dev/null
$farhand certs issue operator operator --robot ur5 --dir $authority >/dev/null
cp -R $authority/netem.gate/. /keys/netem/
cp -R $authority/robot.ur5/. /keys/robot/
cp -R $authority/operator.operator/. /keys/operator/
echo "keys: made for netem, robot ur5 and its operator"
