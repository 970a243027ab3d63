#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A Universal Robots arm as a backend of palpate, over ur_rtde.

NEVER RUN ON AN ARM: written from the published interface of ur_rtde, and tested with a replacement of ur_rtde. UR.md
describes the steps before and during the first taps.
"""
import argparse
import json
import math
import os
import sys

from arm_lock import Held, hold_arm
from ur_moves import ARRIVED, RETRY, Arm, Asks, Failed, Fault, Over, check, distance, length

MARGIN = 0.02  # metres; a tap may begin only if the tip is at most this far outside the area
UPRIGHT = math.cos(math.radians(5))
NO_TOOL = 0.001  # metres; a shorter TCP offset shows that no tool is set


class Onset:
    """Detects that the threshold is reached, and computes the height where the force began to rise. That height is on
    the line through the last reading below half of the threshold. The sign of the force does not matter."""

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
    """Makes taps in the frame of the scene."""

    def __init__(self, arm, corner, rotation):
        self.arm, self.corner, self.rotation = arm, corner, rotation

    def tap(self, ask):
        """Returns the answer to a request, without the number of the tap."""
        arm, motion, desk = self.arm, ask["motion"], ask["desk"]
        if arm.trouble:
            raise arm.trouble
        arm.look()
        arm.look()  # The first state may be older than a cable fault that occurred since the last tap.
        begin, outcome = arm.stamp, None
        self.check_begin(ask)
        here = arm.pose()
        above = self.base(ask["x"], ask["y"], desk + motion["hover"]) + here[3:]
        floor = self.base(ask["x"], ask["y"], desk - motion["overrun"]) + here[3:]
        high = above[:2] + [max(here[2], above[2])] + here[3:]
        for pose in high, above, floor:
            if not arm.control.isPoseWithinSafetyLimits(pose):
                raise Failed("unreachable", "out of the robot's reach or of its safety limits; nothing has moved")
        try:
            self.approach(here, high, above, motion)
        except TimeoutError:
            raise Fault(f"the arm does not reach the position above the tap: {arm.slider()}; clear its path, {RETRY}") from None
        try:
            contact = self.descend(floor, motion, arm.stamp + motion["timeout"])
        except TimeoutError:
            contact, outcome = None, Failed("timeout", f"no contact within {motion['timeout']:g} s; {arm.slider()}, the "
                                                       "arm was raised")
        try:
            arm.follow(above, motion["retreat_speed"])
        except TimeoutError:
            raise Fault(f"the arm does not move up again: {arm.slider()}; clear its path, {RETRY}") from None
        if outcome:
            raise outcome
        if not contact:
            raise Failed("no_contact", f"no contact down to {1000 * motion['overrun']:g} mm below the desk")
        left = arm.rest(motion["tare"])[2]
        if abs(left) > motion["threshold"] / 2:
            raise Failed("aborted", f"{left:.1f} N remained after the tap: its contact is rejected")
        height, force = contact
        return {"outcome": "contact", "height": height - self.corner[2], "force": force, "seconds": arm.stamp - begin}

    def approach(self, here, high, above, motion):
        """Moves up if necessary, sideways, and down to `above` no faster than `speed`. All parts of the first approach
        are as slow, because TCP, corner or rotation may be wrong."""
        arm, slow = self.arm, motion["speed"]
        up = here[:2] + high[2:]
        for target, speed in (up, motion["retreat_speed"]), (high, motion["travel_speed"]), (above, slow):
            if distance(arm.pose(), target) > ARRIVED:
                arm.follow(target, speed if arm.approached else slow)
        arm.approached = True

    def descend(self, floor, motion, until):
        """Descends to a contact or to `floor`. Returns height and force of the contact, or None."""
        arm = self.arm
        arm.zero(motion["tare"])
        # moveUntilContact() is not used, because it has no lower limit of the height and no threshold in newtons.
        onset = Onset(motion["threshold"])
        contact = arm.follow(floor, motion["speed"], until, onset)
        return contact and (onset.height(*contact), abs(contact[1][2]))

    def base(self, x, y, height):
        """Returns a position of the scene in the robot's base frame."""
        c, s = math.cos(self.rotation), math.sin(self.rotation)
        return [self.corner[0] + c * x - s * y, self.corner[1] + s * x + c * y, self.corner[2] + height]

    def check_begin(self, ask):
        """Raises Fault unless the arm is above the area with its tool down, because other obstacles are unknown."""
        motion, area, pose = ask["motion"], ask["area"], self.arm.pose()
        if motion["type"] != "continuous" or motion["adaptive_hover"]:
            raise Fault("this program supports only motion.type continuous without adaptive_hover: change the config")
        if not self.arm.approached:
            self.check_tool()
        if -tool_axis(pose) < UPRIGHT:
            raise Fault(f"the tool does not point down within 5 degrees: turn it by hand, {RETRY}")
        c, s = math.cos(self.rotation), math.sin(self.rotation)
        dx, dy = pose[0] - self.corner[0], pose[1] - self.corner[1]
        x, y, height = c * dx + s * dy, c * dy - s * dx, pose[2] - self.corner[2] - ask["desk"]
        beside = max(-x, x - area["width"], -y, y - area["depth"])
        if beside > MARGIN or height < -motion["overrun"] - MARGIN:
            raise Fault(f"the tip stands at x {x:.3f}, y {y:.3f}, {height:.3f} m above the desk, outside the area: "
                        f"move it above the area by hand, {RETRY}")

    def check_tool(self):
        """Raises Fault without a TCP: the robot would move its flange, not the tip, and push the tool into the desk."""
        tcp = self.arm.control.getTCPOffset()
        if not tcp:
            raise Fault(f"the robot does not report its TCP: check the pendant's log, {RETRY}")
        if length(tcp[:3]) < NO_TOOL:
            raise Fault(f"the robot's TCP is its flange: set that of the tool, the tip, on the pendant, {RETRY}")
        millimetres = ", ".join(f"{1000 * value:.1f}" for value in tcp[:3])
        print(f"the TCP is at {millimetres} mm from the flange; {self.arm.slider()}", file=sys.stderr)


def tool_axis(pose):
    """Returns the upward component of the tool's z axis: the last entry of the matrix of a rotation vector."""
    angle = length(pose[3:])
    return 1.0 if angle == 0.0 else math.cos(angle) + (1 - math.cos(angle)) * (pose[5] / angle) ** 2


def connect(host, asks, force_limit):
    """Connects to the robot and returns its arm. Nothing moves and nothing is uploaded before the robot's state is checked
    and the arm is locked."""
    try:
        lock = hold_arm(f"UR {host}")
    except Held as held:
        raise Fault(f"{held}; wait until that process has ended, or end it, {RETRY}") from None
    except OSError as error:
        raise Fault(f"the arm UR {host} cannot be locked: {error}; allow Python to create unix sockets, {RETRY}") from None
    try:
        import rtde_control
        import rtde_receive

        receive = rtde_receive.RTDEReceiveInterface(host)
        check(receive)
        control = rtde_control.RTDEControlInterface(host)
    except ImportError as error:
        raise Fault(f"{error}: install ur_rtde for {sys.executable}, or name a Python that has it in backend.command "
                    f"(UR.md, step 1), {RETRY}") from None
    except RuntimeError as error:  # ur_rtde raises RuntimeError for each of its own errors
        raise Fault(f"no connection to {host}: {error}; {RETRY}") from None
    arm = Arm(control, receive, asks, force_limit)
    arm.lock = lock  # the lock is held as long as this object exists
    return arm


def serve(arguments, asks, answers):
    """Answers requests until stdin ends or SIGTERM arrives. The arm rests then, as after a fault."""
    arm = None
    try:
        while not asks.ended:
            ask = asks.next()
            if ask is None:
                asks.look(0.02)
                if arm:
                    arm.idle()
                continue
            begin = arm.stamp if arm else None
            try:
                arm = arm or connect(arguments.host, asks, arguments.force_limit)
                answer = Tapper(arm, arguments.corner, math.radians(arguments.rotation)).tap(ask)
            except Failed as failed:
                answer = {"outcome": failed.outcome, "reason": str(failed)}
            except (Fault, RuntimeError) as fault:
                known = isinstance(fault, Fault)
                reason = str(fault) if known else f"ur_rtde: {fault}; check the arm, {RETRY}"
                if arm and not known:
                    arm.lost = True
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
    # ur_rtde prints on stdout, which must contain only answers. The answers therefore get a copy of stdout.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    serve(arguments, Asks(), answers)


if __name__ == "__main__":
    main()
