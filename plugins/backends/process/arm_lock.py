# SPDX-License-Identifier: MIT
"""A lock for each arm, for programs of the backend `process`: the lock of a record keeps two processes from one run, but
not two runs from one arm. It is that of palpate's own backends (framework/shared/children/arm_lock.hpp)."""
import errno
import os
import socket
import struct


class Held(Exception):
    """Another process has the arm; the text says which."""


def hold_arm(arm):
    """Locks `arm`, a name such as "UR 192.168.56.101" of which 95 bytes count, and returns an object: the lock is held
    until that is closed or the process has ended. Forked children do not hold it. Raises Held, and OSError where the
    system makes no unix socket. Not excluded are processes of other machines, and of containers with a network of their
    own."""
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
    """The process that holds the name, in words."""
    with socket.socket(socket.AF_UNIX) as caller:
        caller.setblocking(False)
        try:
            caller.connect(name)
            pid = struct.unpack("3i", caller.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12))[0]
        except OSError:
            pid = 0
    return f"process {pid}" if pid else "another process"
