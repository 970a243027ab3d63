# SPDX-License-Identifier: MIT
"""Supervised linear moves of a Universal Robots arm over ur_rtde; used by ur.py."""
import collections
import json
import math
import os
import select
import signal
import sys
import time

ACCELERATION = 0.5  # m/s^2; used in every move
DECELERATION = 2.0  # m/s^2; used in every stop: 20 cm/s become 0 in 0.1 s, well within the time of the watchdog
WATCHDOG = 5.0  # Hz; the controller stops the arm after 0.2 s without a message
FRESH = 0.2  # seconds; the connection counts as lost after this time without a new state of the robot
READINGS = 3  # number of consecutive new readings that count as a contact, because a single reading may be a spike
ARRIVED = 0.0005  # metres; the tip has arrived if it is this near to the target
WINDOW = 0.1  # seconds; the speed of the tip is an average over this time, because single samples are noisy
AT_REST = 0.001  # m/s; below this speed, the arm is at rest
STOPPING = 1.0  # seconds; time limit of a stop

RETRY = "then run 'palpate resume --retry-failed'"


class Fault(Exception):
    """No tap is possible until a person has checked the arm."""


class Failed(Exception):
    """The tap failed; the arm can continue."""

    def __init__(self, outcome, reason):
        super().__init__(reason)
        self.outcome = outcome


class Over(Exception):
    """The run has ended, or requests the end of this program."""


class Asks:
    """Reads the lines of stdin without waiting, so that a moving arm notices the end of its run."""

    def __init__(self):
        self.ended = False
        self.text = b""
        signal.signal(signal.SIGTERM, self.end)

    def end(self, *_):
        self.ended = True

    def look(self, seconds=0.0):
        if select.select([0], [], [], seconds)[0]:
            got = os.read(0, 65536)
            self.text += got
            self.ended = self.ended or not got

    def next(self):
        """Returns the next request, or None if none has arrived."""
        line, end, rest = self.text.partition(b"\n")
        if not end:
            return None
        self.text = rest
        return json.loads(line)


class Arm:
    """Moves in straight lines under supervision."""

    def __init__(self, control, receive, asks, force_limit):
        self.control, self.receive, self.asks = control, receive, asks
        self.force_limit = force_limit  # newtons; limit of the force in any motion
        self.zero_force = [0.0] * 3
        self.stamp = None
        self.poses = collections.deque()  # pairs (stamp, pose) of the last WINDOW seconds
        self.lost = False  # whether messages may no longer reach the robot; then no command is sent
        self.trouble = None  # error that occurred between two taps
        self.approached = False  # whether the first approach is complete

    def look(self):
        """Waits for the next state of the robot. Raises Fault or Over if the arm must not move on."""
        patience = time.monotonic() + FRESH
        while True:
            late = time.monotonic() > patience
            stamp = self.receive.getTimestamp()
            if stamp != self.stamp:
                break
            if late:
                self.lost = True
                raise Fault(f"no new state from the robot for {FRESH} s: check the cable, and that the arm stands still, {RETRY}")
            time.sleep(0.0005)
        self.stamp = stamp
        self.poses.append((stamp, self.pose()))
        while self.poses[0][0] < stamp - WINDOW:
            self.poses.popleft()
        self.asks.look()
        if self.asks.ended:
            raise Over
        self.kick()

    def kick(self):
        """Resets the watchdog. Raises Fault if the robot must not move."""
        check(self.receive)
        if not self.control.kickWatchdog():
            raise Fault(f"ur_rtde's script no longer runs on the robot: check the pendant's log, {RETRY}")

    def idle(self):
        """Calls kick() between two taps. An error becomes the answer to the next request, because a person may have
        stopped the arm on purpose."""
        try:
            if not self.trouble:
                self.kick()
        except (Fault, RuntimeError) as trouble:
            self.trouble = trouble
            print(f"between two taps: {trouble}", file=sys.stderr)

    def pose(self):
        return list(self.receive.getActualTCPPose())

    def force(self):
        """Returns the force along x, y, z of the base, newtons, relative to the last zero."""
        return [f - zero for f, zero in zip(self.receive.getActualTCPForce(), self.zero_force)]

    def moves(self):
        """Returns whether the tip moves, from its mean positions in the two halves of the last WINDOW seconds. Returns
        True if fewer seconds are known."""
        middle = self.stamp - WINDOW / 2
        halves = [[pose for stamp, pose in self.poses if (stamp > middle) == late] for late in (False, True)]
        if not all(halves) or self.poses[0][0] > self.stamp - 0.9 * WINDOW:
            return True
        before, now = ([sum(axis) / len(half) for axis in zip(*half)] for half in halves)
        return distance(before, now) / (WINDOW / 2) > AT_REST

    def slider(self):
        return f"the speed slider stands at {100 * self.receive.getTargetSpeedFraction():.0f} %"

    def rest(self, seconds):
        """Waits until the arm has rested for `seconds`. Returns the mean force of this time."""
        since, sum_, count = None, [0.0] * 3, 0
        patience = None
        while True:
            self.look()
            patience = patience or self.stamp + seconds + 5.0
            if self.stamp > patience:
                raise Fault(f"the arm does not come to rest: check what moves it, {RETRY}")
            if self.moves():
                since = None
            elif since is None:
                since, sum_, count = self.stamp, [0.0] * 3, 0
            else:
                sum_ = [a + f for a, f in zip(sum_, self.force())]
                count += 1
                if self.stamp - since >= seconds:
                    return [a / count for a in sum_]

    def zero(self, seconds):
        """Makes the force at rest the zero: first in the sensor, then by subtracting the remaining offset."""
        self.rest(seconds)
        if not self.control.zeroFtSensor():
            raise Fault(f"the robot does not zero its force sensor: use an e-Series or newer, {RETRY}")
        self.zero_force = [0.0] * 3
        self.zero_force = self.rest(seconds)

    def follow(self, target, speed, until=None, touched=None):
        """Moves to `target`; the controller cannot move beyond it. Returns None on arrival.

        With `touched`, the arm stops after READINGS consecutive readings for which `touched` is true. Returns the
        pose and the force of the first of these readings. After the robot's time `until`, the arm stops, and the
        function raises TimeoutError.
        """
        way = distance(self.pose(), target)
        until = until or self.stamp + 5.0 + 3.0 * way / speed
        limit = self.force_limit + length(self.force())
        # The watchdog is set before every move, because it is off after ur_rtde has reconnected automatically.
        if not self.control.setWatchdog(WATCHDOG):
            check(self.receive)
            raise Fault(f"the robot rejects the watchdog: check the pendant's log, {RETRY}")
        if not self.control.moveL(target, speed, ACCELERATION, True):
            check(self.receive)
            raise Fault(f"the robot rejected a move: check the pendant's log, {RETRY}")
        contacts, pushed = [], 0
        try:
            while True:
                self.look()
                force, pose = self.force(), self.pose()
                contacts = contacts + [(pose, force)] if touched and touched(pose, force) else []
                pushed = pushed + 1 if length(force) >= limit else 0
                if len(contacts) == READINGS:
                    break
                if pushed == READINGS:
                    raise Fault(f"the arm is pushed with {length(force):.0f} N on its way: free it, {RETRY}")
                if self.stamp > until:
                    break
                if distance(pose, target) < ARRIVED and not self.moves():
                    return None
        except (Over, Fault):
            self.halt()
            raise
        self.stop()
        if len(contacts) < READINGS:
            raise TimeoutError
        return contacts[0]

    def halt(self):
        """Begins to stop. If new states are missing, nothing is sent, because ur_rtde would wait 300 s for an answer.
        The watchdog then stops the arm, as it is no longer reset."""
        if self.lost:
            return
        try:
            self.control.stopL(DECELERATION, True)
        except RuntimeError as error:
            self.lost = True
            print(f"stopL: {error}", file=sys.stderr)

    def stop(self):
        """Stops and waits for standstill. Another command during the stop would end ur_rtde's script."""
        self.halt()
        until = self.stamp + STOPPING
        while self.moves():
            self.look()
            if self.stamp > until:
                raise Fault(f"the arm still moves {STOPPING:g} s after its stop: check what moves it, {RETRY}")

    def leave(self):
        """Ends the script on the robot. The watchdog is not reset any more."""
        try:
            if not self.lost:
                self.control.stopScript()
            self.control.disconnect()
            self.receive.disconnect()
        except RuntimeError as error:
            print(f"leaving: {error}", file=sys.stderr)


def check(receive):
    """Raises Fault if the robot's state forbids motion."""
    if receive.isEmergencyStopped():
        raise Fault(f"emergency stop: release the button, switch the arm on, bring the tip above the area, {RETRY}")
    if receive.isProtectiveStopped():
        raise Fault(f"protective stop: free the arm if it presses, confirm on the pendant, {RETRY}")
    if receive.getSafetyMode() not in (1, 2):  # safety modes 1 (normal) and 2 (reduced)
        raise Fault(f"safety mode {receive.getSafetyMode()}, not normal: clear it on the pendant, {RETRY}")
    if receive.getRobotMode() != 7:  # robot mode 7 (running)
        raise Fault(f"robot mode {receive.getRobotMode()}, not running: switch on and release the brakes, {RETRY}")


def length(vector):
    return math.sqrt(sum(value * value for value in vector))


def distance(pose, other):
    return length([a - b for a, b in zip(pose[:3], other[:3])])
