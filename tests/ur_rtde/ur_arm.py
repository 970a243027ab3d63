# SPDX-License-Identifier: MIT
"""The arm behind the stand-ins for ur_rtde: it moves in time of its own, one step a look at its clock, so that a test
takes as long as the machine likes. UR_LOG names the file in which it notes what is done to it, UR_FAULT what goes wrong:
`KIND@N` in its Nth move down, counted over all programs; KIND one of protective, emergency, lost, frozen, cable,
reconnect, script, spike, missing, pushed, sticky, slow, restless (it creeps on after its stop). After the Nth move down
has ended, before the next tap: `idle@N` is one kick that is refused, `idle_cable@N` a cable that is pulled, after which
one newer state is still there to be read. And from the start `mode`, `flange` (no TCP is set), `noisy` (samples of speed
and pose), `high` (it stands half a metre above the area).

What ur_rtde does is modelled after its sources of 2024: every command but a kick waits for the robot's answer, for up to
300 s; lost, the connection of the commands is made again by the next of them, with the script, but without a watchdog."""
import math
import os
import random
import time

STEP = 0.002  # s, 500 Hz
STIFFNESS = 5000.0  # N/m
EXECUTION_TIMEOUT = 5.0  # s that a command waits for its answer: 300 in ur_rtde, but the note says enough
SPEED_NOISE = 0.0005  # m/s, of the fault `noisy`
POSE_NOISE = 0.00001  # m
CORNER = (0.4, -0.1, 0.05)  # of the area, m
AREA = 0.23
RADIUS = 0.06  # of the dome in its middle
DOWN = [math.pi, 0.0, 0.0]


def surface(x, y):
    """Height of desk and dome in the base frame."""
    away = math.hypot(x - CORNER[0] - AREA / 2, y - CORNER[1] - AREA / 2)
    return CORNER[2] + math.sqrt(max(0.0, RADIUS**2 - away**2))


class Arm:
    def __init__(self):
        self.log = open(os.environ["UR_LOG"], "a")
        self.fault, _, at = os.environ.get("UR_FAULT", "").partition("@")
        self.at = int(at or 0)
        with open(os.environ["UR_LOG"]) as before:
            self.descents = sum(line == "down\n" for line in before)
        self.time = 100.0
        self.position = [CORNER[0] + 0.01, CORNER[1] + 0.01, CORNER[2] + (0.5 if self.fault == "high" else 0.05)]
        self.random = random.Random(1)
        self.velocity = [0.0] * 3
        self.target, self.speed = None, 0.0
        self.offset = 3.0  # N, of the sensor
        self.zeroed = 0.0
        self.safety, self.mode = 1, 3 if self.fault == "mode" else 7
        self.script = self.connected = True
        self.frozen = self.unplugged = False
        self.steps = self.steps_at_kick = 0
        self.hurried = False  # faster than a descent before the first one
        self.active = False  # the fault, in this descent
        self.watchdog, self.kicked = None, self.time
        self.spikes = 0

    def note(self, what):
        print(what, file=self.log, flush=True)

    def step(self):
        self.time += STEP
        self.steps += 1
        if self.active and self.fault == "slow":
            time.sleep(STEP)
        if self.watchdog and self.script and self.time - self.kicked > 1.0 / self.watchdog:
            self.end_script("watchdog")
        self.misbehave()
        self.velocity = [0.0] * 3
        if not self.script or not self.target or self.safety not in (1, 2):
            return
        way = [t - p for t, p in zip(self.target, self.position)]
        left = math.sqrt(sum(w * w for w in way))
        step = min(left, self.speed * STEP)
        if left < 1e-9:
            self.target = None
            return
        self.velocity = [w / left * step / STEP for w in way]
        if self.descents == 0 and math.hypot(*self.velocity) > 0.03 and not self.hurried:
            self.note("fast approach")
            self.hurried = True
        self.position = [p + v * STEP for p, v in zip(self.position, self.velocity)]
        assert self.force() < 60.0, "pressed through what it was to feel"

    def misbehave(self):
        """Faults begin 2 cm above the desk or what is on it."""
        if not self.active or self.position[2] > surface(*self.position[:2]) + 0.02:
            return
        if self.fault == "protective":
            self.safety, self.target = 3, None
        elif self.fault == "emergency":
            self.safety, self.mode, self.target = 7, 3, None
        elif self.fault == "script":
            self.end_script("error")
        elif self.fault == "lost":
            self.connected = False
        elif self.fault == "frozen":
            self.frozen = True
        elif self.fault == "cable":
            self.frozen = self.unplugged = True
        elif self.fault == "reconnect":
            self.note("reconnected")
            self.watchdog, self.target, self.active = None, None, False

    def answer(self):
        """Waits for the robot's answer to a command, deaf to signals as ur_rtde is."""
        if self.unplugged:
            self.note("waits for an answer")
            time.sleep(EXECUTION_TIMEOUT)

    def refuses_kick(self):
        """Begins the faults between two taps: of two kicks without a step of the arm between them the second is made
        there. Returns whether this kick is refused."""
        idle, self.steps_at_kick = self.steps == self.steps_at_kick, self.steps
        if not idle or self.descents != self.at or self.fault not in ("idle", "idle_cable"):
            return False
        fault, self.fault = self.fault, ""
        if fault == "idle_cable":
            self.step()
            self.frozen = self.unplugged = True
            return False
        self.note("kick refused")
        return True

    def noise(self, deviation):
        return [self.random.gauss(0.0, deviation if self.fault == "noisy" else 0.0) for _ in range(3)]

    def end_script(self, why):
        self.note(why)
        self.script, self.target = False, None

    def force(self):
        """Newtons that what it stands on pushes back with."""
        free = self.active and self.fault == "missing"
        return 0.0 if free else STIFFNESS * max(0.0, surface(*self.position[:2]) - self.position[2])

    def wrench(self):
        self.spikes += 1
        push = self.force()
        if self.active and self.fault == "spike" and self.spikes % 50 == 0:
            push += 40.0
        if self.active and self.fault == "sticky":
            push += 5.0
        side = 50.0 if self.active and self.fault == "pushed" and self.velocity[2] < 0 else 0.0
        return [side, 0.0, self.offset + push - self.zeroed, 0.0, 0.0, 0.0]

    def move(self, target, speed):
        if not self.watchdog:
            self.note("unguarded move")
        down = target[2] < CORNER[2]  # to the floor
        if down and math.dist(target[:2], self.position[:2]) < 1e-3:
            self.descents += 1
            self.note("down")
            self.active = self.descents == self.at
        elif self.fault not in ("missing", "sticky"):
            self.active = False
        self.target, self.speed = list(target[:3]), speed

    def stop(self):
        self.target = None
        if self.active and self.fault == "restless":
            x, y, z = self.position
            self.target, self.speed = [x + 0.03, y, z + 0.03], 0.005


ARM = None


def arm():
    """One arm for both interfaces, there from the first on."""
    global ARM
    ARM = ARM or Arm()
    return ARM
