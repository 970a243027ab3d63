# SPDX-License-Identifier: MIT
"""Stands in for ur_rtde's module of this name: those methods that ur.py calls, with their published signatures."""
from ur_arm import DOWN, POSE_NOISE, SPEED_NOISE, arm


class RTDEReceiveInterface:
    def __init__(self, hostname, frequency=-1.0, variables=(), verbose=False, use_upper_range_registers=False):
        if not hostname.startswith("stub"):
            raise RuntimeError("Timeout connecting to UR dashboard server.")
        print("as ur_rtde does, this prints on stdout", flush=True)
        self.arm = arm()

    def getTimestamp(self):
        if self.arm.connected and not self.arm.frozen:
            self.arm.step()
        return self.arm.time

    def getActualTCPPose(self):
        return [p + n for p, n in zip(self.arm.position, self.arm.noise(POSE_NOISE))] + DOWN

    def getActualTCPSpeed(self):
        return [v + n for v, n in zip(self.arm.velocity, self.arm.noise(SPEED_NOISE))] + [0.0] * 3

    def getTargetSpeedFraction(self):
        return 1.0

    def getActualTCPForce(self):
        return self.arm.wrench()

    def getSafetyMode(self):
        return self.arm.safety

    def getRobotMode(self):
        return self.arm.mode

    def isProtectiveStopped(self):
        return self.arm.safety == 3

    def isEmergencyStopped(self):
        return self.arm.safety in (6, 7)

    def disconnect(self):
        self.arm.note("receive disconnected")
