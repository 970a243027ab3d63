#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A Universal Robots arm as a backend of palpate, over ur_rtde.

NEVER RUN ON AN ARM: written from the published interface of ur_rtde, and tested against a stand-in for it. UR.md beside
it says what to do before and during the first taps.
"""
import argparse
import json
import math
import os
import select
import signal
import sys
import time

ACCELERATION = 0.5  # m/s^2, of every move
DECELERATION = 2.0  # m/s^2, of every stop: from 20 cm/s in 0.1 s, well within the watchdog's time
WATCHDOG = 5.0  # Hz: the controller stops the arm when it hears nothing for 0.2 s
FRESH = 0.2  # s without a new state of the robot: the connection is lost
READINGS = 3  # new ones in a row that make a contact: one alone may be a spike
ARRIVED = 0.0005  # m from the target
AT_REST = 0.001  # m/s
MARGIN = 0.02  # m around the area in which the tip may stand when a tap begins
UPRIGHT = math.cos(math.radians(5))

RETRY = "then 'palpate resume --retry-failed'"


class Fault(Exception):
    """No other tap can be made until somebody has seen to the arm."""


class Failed(Exception):
    """The tap failed, the arm can go on."""

    def __init__(self, outcome, reason):
        super().__init__(reason)
        self.outcome = outcome


class Over(Exception):
    """The run is gone, or wants this program to end."""


class Asks:
    """The lines of stdin, read without waiting: an arm that moves must notice that its run has ended."""

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
        """The next ask, None if none has come."""
        line, end, rest = self.text.partition(b"\n")
        if not end:
            return None
        self.text = rest
        return json.loads(line)


class Arm:
    """Moves in straight lines, every one of them watched."""

    def __init__(self, control, receive, asks, force_limit):
        self.control, self.receive, self.asks = control, receive, asks
        self.force_limit = force_limit  # N, beyond which it stops wherever it is
        self.zero_force = [0.0] * 3
        self.stamp = None

    def look(self):
        """Waits for the next state of the robot, and raises what keeps it from moving on."""
        patience = time.monotonic() + FRESH
        while True:
            late = time.monotonic() > patience
            stamp = self.receive.getTimestamp()
            if stamp != self.stamp:
                break
            if late:
                raise Fault(f"no new state of the robot for {FRESH} s: look at cable and arm, it should stand, {RETRY}")
            time.sleep(0.0005)
        self.stamp = stamp
        self.asks.look()
        if self.asks.ended:
            raise Over
        check(self.receive)
        if not self.control.kickWatchdog():
            raise Fault(f"ur_rtde's script no longer runs on the robot: look at the pendant's log, {RETRY}")

    def pose(self):
        return list(self.receive.getActualTCPPose())

    def force(self):
        """Newtons along x, y, z of the base since it was last zeroed."""
        return [f - zero for f, zero in zip(self.receive.getActualTCPForce(), self.zero_force)]

    def rest(self, seconds):
        """Waits until the arm has been at rest for so long; the mean of the force meanwhile."""
        since, sum_, count = None, [0.0] * 3, 0
        patience = None
        while True:
            self.look()
            patience = patience or self.stamp + seconds + 5.0
            if self.stamp > patience:
                raise Fault(f"the arm does not come to rest: look what moves it, {RETRY}")
            if length(self.receive.getActualTCPSpeed()[:3]) > AT_REST:
                since = None
            elif since is None:
                since, sum_, count = self.stamp, [0.0] * 3, 0
            else:
                sum_ = [a + f for a, f in zip(sum_, self.force())]
                count += 1
                if self.stamp - since >= seconds:
                    return [a / count for a in sum_]

    def zero(self, seconds):
        """Takes the force at rest for zero: first the sensor, then what is left of it."""
        self.rest(seconds)
        if not self.control.zeroFtSensor():
            raise Fault(f"the robot does not zero its force sensor: is it an e-Series or newer? {RETRY}")
        self.zero_force = [0.0] * 3
        self.zero_force = self.rest(seconds)

    def follow(self, target, speed, until=None, touched=None):
        """Moves to `target`, beyond which the controller itself does not go; None when it is there.

        With `touched`: pose and force of the first of READINGS readings in a row for which that holds, and then the
        arm stands. After `until`, in the robot's seconds, it raises TimeoutError, standing too.
        """
        way = distance(self.pose(), target)
        until = until or self.stamp + 5.0 + 3.0 * way / speed
        limit = self.force_limit + length(self.force())
        if not self.control.moveL(target, speed, ACCELERATION, True):
            check(self.receive)
            raise Fault(f"the robot did not take a move: look at the pendant's log, {RETRY}")
        contacts, pushed = [], 0
        try:
            while True:
                self.look()
                force, pose = self.force(), self.pose()
                contacts = contacts + [(pose, force)] if touched and touched(pose, force) else []
                pushed = pushed + 1 if length(force) >= limit else 0
                if len(contacts) == READINGS:
                    self.halt()
                    return contacts[0]
                if pushed == READINGS:
                    raise Fault(f"something pushes the arm with {length(force):.0f} N on its way: free it, {RETRY}")
                if self.stamp > until:
                    self.halt()
                    raise TimeoutError
                if distance(pose, target) < ARRIVED and length(self.receive.getActualTCPSpeed()[:3]) < AT_REST:
                    return None
        except (Over, Fault, RuntimeError):
            self.halt()
            raise

    def halt(self):
        try:
            self.control.stopL(DECELERATION)
        except RuntimeError as error:  # the connection is gone: now it is the watchdog that stops the arm
            print(f"stopL: {error}", file=sys.stderr)

    def leave(self):
        """Ends the script on the robot, after which nobody keeps the watchdog quiet."""
        try:
            self.control.stopScript()
            self.control.disconnect()
            self.receive.disconnect()
        except RuntimeError as error:
            print(f"leaving: {error}", file=sys.stderr)


class Onset:
    """Says when the threshold is reached, and then where the force began to rise: on the line through the last reading
    below half of it. Whatever the sign of the robot's force, a push is a push."""

    def __init__(self, threshold):
        self.threshold = threshold
        self.below = None

    def __call__(self, pose, force):
        push = abs(force[2])
        if push < self.threshold / 2:
            self.below = pose[2], push
        return push >= self.threshold

    def height(self, pose, force):
        if not self.below:
            return pose[2]
        height, push = self.below
        return height + (height - pose[2]) * push / (abs(force[2]) - push)


class Tapper:
    """One tap after another, in the frame of the scene."""

    def __init__(self, arm, corner, rotation):
        self.arm, self.corner, self.rotation = arm, corner, rotation

    def tap(self, ask):
        """The answer to an ask, but for its number."""
        arm, motion, desk = self.arm, ask["motion"], ask["desk"]
        arm.look()
        begin, outcome = arm.stamp, None
        self.check_begin(ask)
        upright = arm.pose()[3:]
        above = self.base(ask["x"], ask["y"], desk + motion["hover"]) + upright
        floor = self.base(ask["x"], ask["y"], desk - motion["overrun"]) + upright
        for pose in above, floor:
            if not arm.control.isPoseWithinSafetyLimits(pose):
                raise Failed("unreachable", "out of the robot's reach or of its safety limits; nothing has moved")
        try:
            contact = self.descend(above, floor, motion, begin + motion["timeout"])
        except TimeoutError:
            contact, outcome = None, Failed("timeout", f"no contact within {motion['timeout']:g} s; the arm was raised")
        try:
            arm.follow(above, motion["retreat_speed"])
        except TimeoutError:
            raise Fault(f"the arm does not get up again: is the speed slider low, the way free? {RETRY}") from None
        if outcome:
            raise outcome
        if not contact:
            raise Failed("no_contact", f"no contact down to {1000 * motion['overrun']:g} mm below the desk")
        left = arm.rest(motion["tare"])[2]
        if abs(left) > motion["threshold"] / 2:
            raise Failed("aborted", f"{left:.1f} N were left after the tap: its contact is not believed")
        height, force = contact
        return {"outcome": "contact", "height": height - self.corner[2], "force": force, "seconds": arm.stamp - begin}

    def descend(self, above, floor, motion, until):
        """From wherever the arm is to a contact below `above`, or to `floor`: height and force of it, or None."""
        arm = self.arm
        here = arm.pose()
        if here[2] < above[2]:
            arm.follow(here[:2] + above[2:], motion["retreat_speed"], until)
        arm.follow(above, motion["travel_speed"], until)
        arm.zero(motion["tare"])
        # Not moveUntilContact(): that knows neither a floor nor newtons.
        onset = Onset(motion["threshold"])
        contact = arm.follow(floor, motion["speed"], until, onset)
        return contact and (onset.height(*contact), abs(contact[1][2]))

    def base(self, x, y, height):
        """A place of the scene in the robot's base frame."""
        c, s = math.cos(self.rotation), math.sin(self.rotation)
        return [self.corner[0] + c * x - s * y, self.corner[1] + s * x + c * y, self.corner[2] + height]

    def check_begin(self, ask):
        """It does not know what else stands in the room: it begins above the area, tool down, or not at all."""
        motion, area, pose = ask["motion"], ask["area"], self.arm.pose()
        if motion["type"] != "continuous" or motion["adaptive_hover"]:
            raise Fault("this program knows motion.type continuous without adaptive_hover: change the config")
        if -tool_axis(pose) < UPRIGHT:
            raise Fault(f"the tool does not point down within 5 degrees: turn it by hand, {RETRY}")
        c, s = math.cos(self.rotation), math.sin(self.rotation)
        dx, dy = pose[0] - self.corner[0], pose[1] - self.corner[1]
        x, y, height = c * dx + s * dy, c * dy - s * dx, pose[2] - self.corner[2] - ask["desk"]
        beside = max(-x, x - area["width"], -y, y - area["depth"])
        if beside > MARGIN or height < -motion["overrun"] - MARGIN:
            raise Fault(f"the tip stands at x {x:.3f}, y {y:.3f}, {height:.3f} m above the desk, not above the area: "
                        f"bring it there by hand, {RETRY}")


def check(receive):
    """Raises what the robot itself says against moving."""
    if receive.isEmergencyStopped():
        raise Fault(f"emergency stop: release the button, switch the arm on, bring the tip above the area, {RETRY}")
    if receive.isProtectiveStopped():
        raise Fault(f"protective stop: free the arm if it presses, confirm on the pendant, {RETRY}")
    if receive.getSafetyMode() not in (1, 2):  # normal, reduced
        raise Fault(f"safety mode {receive.getSafetyMode()}, not normal: clear it on the pendant, {RETRY}")
    if receive.getRobotMode() != 7:  # running
        raise Fault(f"robot mode {receive.getRobotMode()}, not running: switch on and release the brakes, {RETRY}")


def length(vector):
    return math.sqrt(sum(value * value for value in vector))


def distance(pose, other):
    return length([a - b for a, b in zip(pose[:3], other[:3])])


def tool_axis(pose):
    """How far the tool's z axis points up: the last entry of the matrix of a rotation vector."""
    angle = length(pose[3:])
    return 1.0 if angle == 0.0 else math.cos(angle) + (1 - math.cos(angle)) * (pose[5] / angle) ** 2


def connect(host, asks, force_limit):
    """Joins the robot, but moves nothing and uploads nothing before its state is known to be good."""
    try:
        import rtde_control
        import rtde_receive

        receive = rtde_receive.RTDEReceiveInterface(host)
        check(receive)
        control = rtde_control.RTDEControlInterface(host)
        if not control.setWatchdog(WATCHDOG):
            raise Fault(f"the robot takes no watchdog: look at the pendant's log, {RETRY}")
    except ImportError as error:
        raise Fault(f"{error}: install ur_rtde for {sys.executable}, {RETRY}") from None
    except RuntimeError as error:  # what ur_rtde makes of all that goes wrong on its side
        raise Fault(f"no connection to {host}: {error}; {RETRY}") from None
    return Arm(control, receive, asks, force_limit)


def serve(arguments, asks, answers):
    """Answers every ask until stdin ends or SIGTERM comes. The arm stands then, as it does after a fault."""
    arm = None
    try:
        while not asks.ended:
            ask = asks.next()
            if ask is None:
                asks.look(0.02)
                if arm:
                    arm.control.kickWatchdog()
                continue
            begin = arm.stamp if arm else None
            try:
                arm = arm or connect(arguments.host, asks, arguments.force_limit)
                answer = Tapper(arm, arguments.corner, math.radians(arguments.rotation)).tap(ask)
            except Failed as failed:
                answer = {"outcome": failed.outcome, "reason": str(failed)}
            except (Fault, RuntimeError) as fault:
                known = isinstance(fault, Fault)
                reason = str(fault) if known else f"ur_rtde: {fault}; look at the arm, {RETRY}"
                answer = {"outcome": "aborted", "reason": reason, "ends_run": True}
            answer.setdefault("seconds", arm.stamp - begin if arm and begin else 0.0)
            print(json.dumps({"tap": ask["tap"], **answer}), file=answers, flush=True)
            if "ends_run" in answer and arm:
                arm.leave()
                arm = None
    except Over:
        pass
    finally:
        if arm:
            arm.leave()


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("host", help="the robot's address")
    parser.add_argument("--corner", type=float, nargs=3, metavar=("X", "Y", "Z"), required=True,
                        help="the area's corner in the robot's base frame, metres; Z is that of the scene's height 0")
    parser.add_argument("--rotation", type=float, default=0.0, help="of the area about the vertical, degrees")
    parser.add_argument("--force-limit", type=float, default=30.0, help="newtons at which the arm stops on any way")
    arguments = parser.parse_args()
    # ur_rtde prints on stdout, which is for answers alone.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    serve(arguments, Asks(), answers)


if __name__ == "__main__":
    main()
