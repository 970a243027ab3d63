# SPDX-License-Identifier: MIT
"""A lock for each arm, for programs of the backend `process`: the lock of a record keeps two processes from one run, but
not two runs from one arm. It is that of palpate's own backends (framework/shared/children/arm_lock.hpp)."""
import fcntl
import os
import stat
import tempfile
import urllib.parse


class Held(Exception):
    """Another process has the arm; the text says which."""


def hold_arm(arm, owner=""):
    """Locks `arm`, a name such as "UR 192.168.56.101", and returns a file: the lock is held until that is closed or the
    process has ended. `owner` is what others are told who want the arm. Raises Held, and OSError where no lock can be
    made."""
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    own = os.path.join(tempfile.gettempdir(), f"palpate-{os.geteuid()}")
    folder = os.path.join(runtime, "palpate") if runtime.startswith("/") else own
    try:
        os.mkdir(folder, 0o700)
    except FileExistsError:
        pass
    there = os.lstat(folder)
    if not stat.S_ISDIR(there.st_mode) or there.st_uid != os.geteuid() or there.st_mode & 0o077:
        raise OSError(f"{folder} is not a folder of this user alone: remove it, or set its mode to 0700")
    name = urllib.parse.quote(arm, safe="").replace("~", "%7E")[:240] + ".lock"
    number = os.open(os.path.join(folder, name), os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)
    file = os.fdopen(number, "r+")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        holder = file.readline(4096).strip() or "another process"
        file.close()
        raise Held(f"the arm {arm} is in the hands of {holder}") from None
    file.truncate(0)
    file.write(f"process {os.getpid()}{', ' if owner else ''}{owner}\n")
    file.flush()
    return file
