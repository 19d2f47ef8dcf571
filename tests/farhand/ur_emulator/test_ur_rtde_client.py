"""The client library that others drive UR arms with, unmodified, on the emulated controller."""

import json
import subprocess
import sys

import pytest

from farhand.testing.programs import Program

pytestmark = pytest.mark.realtime
pytest.importorskip("rtde_control")
ADDRESS = "127.0.0.32"
# In a process of its own: its constructors hold Python's lock, for ever where nobody answers.
CLIENT = """
import json, sys, time
import rtde_receive, rtde_control, dashboard_client
host = sys.argv[1]
found = {}
def until(holds):
    end = time.monotonic() + 20
    while not holds() and time.monotonic() < end:
        time.sleep(0.002)
    return holds()
receive = rtde_receive.RTDEReceiveInterface(host)
control = rtde_control.RTDEControlInterface(host, 500.0)
found["mode"] = [receive.getRobotMode(), receive.getSafetyMode()]
within = control.isJointsWithinSafetyLimits
found["limits"] = [within([0, -1, 1, -1, -1, 0]), within([0, 9, 1, -1, -1, 0])]
control.setPayload(1.5, [0.0, 0.0, 0.1])
found["payload"] = until(lambda: receive.getPayload() == 1.5)
control.speedJ([0, 0, 0, 0, 0, 0.4], 2.0, 0.0)
found["speedj"] = until(lambda: abs(receive.getActualQd()[5] - 0.4) < 1e-3)
control.speedStop(5.0)
found["stopped"] = until(lambda: abs(receive.getActualQd()[5]) < 1e-3)
control.speedL([0, 0, 0.05, 0, 0, 0], 1.0)
found["speedl"] = until(lambda: abs(receive.getActualTCPSpeed()[2] - 0.05) < 1e-3)
control.speedStop(5.0)
q = receive.getActualQ(); q[0] += 0.1
control.moveJ(q, 1.0, 1.0)
found["movej"] = until(lambda: abs(receive.getActualQ()[0] - q[0]) < 1e-3)
control.setWatchdog(20.0)
control.speedJ([0, 0, 0, 0, 0, 0.4], 2.0, 0.0)
found["watchdog"] = until(lambda: receive.getSafetyMode() == 3)
board = dashboard_client.DashboardClient(host)
board.connect()
found["dashboard"] = [board.isInRemoteControl(), board.robotmode(), board.getRobotModel()]
print("FOUND" + json.dumps(found), flush=True)
import os; os._exit(0)
"""


def test_it_connects_drives_stops_and_trips_its_watchdog():
    words = ("ur", "emulator", "--address", ADDRESS, "--rate", "500", "--fault-port", "0")
    with Program(*words) as emulator:
        emulator.wait_for("Ctrl-C ends it")
        client = subprocess.run(
            [sys.executable, "-c", CLIENT, ADDRESS], capture_output=True, text=True, timeout=120, check=False
        )
        assert "FOUND" in client.stdout, client.stdout + client.stderr
        found = json.loads(client.stdout.partition("FOUND")[2].splitlines()[0])
        assert found == {
            "mode": [7, 1],
            "limits": [True, False],
            "payload": True,
            "speedj": True,
            "stopped": True,
            "speedl": True,
            "movej": True,
            "watchdog": True,
            "dashboard": [True, "Robotmode: RUNNING", "UR5"],
        }
        assert emulator.interrupt() == 0
