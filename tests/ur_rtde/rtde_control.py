# SPDX-License-Identifier: MIT
"""Stands in for ur_rtde's module of this name: those methods that ur.py calls, with their published signatures."""
from ur_arm import AREA, CORNER, arm


class RTDEControlInterface:
    def __init__(self, hostname, frequency=-1.0, flags=1, ur_cap_port=50002, rt_priority=0):
        self.arm = arm()
        self.arm.note("connected")

    def usable(self, waits=True):
        """As ur_rtde's commands: False once the script has ended or the robot has stopped."""
        if waits:
            self.arm.answer()
        if not self.arm.connected:
            raise RuntimeError("unable to get state data for specified key: runtime_state")
        return self.arm.script and self.arm.safety in (1, 2)

    def setWatchdog(self, min_frequency=10.0):
        self.arm.watchdog, self.arm.kicked = min_frequency, self.arm.time
        return self.usable()

    def kickWatchdog(self):
        self.arm.kicked = self.arm.time
        return not self.arm.refuses_kick() and self.usable(waits=False)

    def moveL(self, pose, speed=0.25, acceleration=1.2, asynchronous=False):
        assert asynchronous, "a move that blocks starves the watchdog"
        if self.usable():
            self.arm.move(pose, speed)
        return self.usable()

    def stopL(self, a=10.0, asynchronous=False):
        self.arm.note("stop")
        if self.usable():
            self.arm.stop()

    def zeroFtSensor(self):
        assert self.arm.target is None and self.arm.force() == 0.0, "zeroed while it moves or touches"
        self.arm.zeroed = self.arm.offset
        return self.usable()

    def getTCPOffset(self):
        return [0.0, 0.0, 0.0 if self.arm.fault == "flange" else 0.15, 0.0, 0.0, 0.0] if self.usable() else []

    def isPoseWithinSafetyLimits(self, pose):
        return self.usable() and pose[0] < CORNER[0] + 0.95 * AREA

    def stopScript(self):
        self.arm.note("script stopped")
        self.usable()

    def disconnect(self):
        self.arm.note("disconnected")
