# SPDX-License-Identifier: MIT
"""A lock per arm for programs of the backend `process`. The lock of a record excludes a second process from a run,
but not a second run from an arm. Backends of palpate use the same lock (framework/shared/children/arm_lock.hpp)."""
import errno
import os
import socket
import struct


class Held(Exception):
    """Another process has the arm; the text contains its process id."""


def hold_arm(arm):
    """Locks `arm`, a name such as "UR 192.168.56.101" (the first 95 bytes count), and returns a lock object. The lock is
    held until the object is closed or the process ends. Forked children do not hold it. Raises Held if another process
    has the arm, and OSError if the system cannot create a unix socket. Processes of other machines, and of containers
    with their own network, are not excluded."""
    name = (b"\0palpate arm " + arm.encode())[:108]
    lock = socket.socket(socket.AF_UNIX)
    try:
        lock.bind(name)
        lock.listen(socket.SOMAXCONN)
    except OSError as error:
        lock.close()
        if error.errno != errno.EADDRINUSE:
            raise
        raise Held(f"the arm {arm} is used by {holder_of(name)}") from None
    os.register_at_fork(after_in_child=lock.close)
    return lock


def holder_of(name):
    """Returns a text that names the process that holds the lock."""
    with socket.socket(socket.AF_UNIX) as caller:
        caller.setblocking(False)
        try:
            caller.connect(name)
            pid = struct.unpack("3i", caller.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12))[0]
        except OSError:
            pid = 0
    return f"process {pid}" if pid else "another process"
