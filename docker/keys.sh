#!/bin/sh
# Makes the demo's certificates once: an authority, and a folder for each program on a volume of its own. The
# authority's secret goes with this container: nobody can be added later, and new volumes mean a new authority.
set -eu
if [ -e /keys/netem/cert.pem ] && [ -e /keys/robot/cert.pem ] && [ -e /keys/operator/cert.pem ]; then
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
