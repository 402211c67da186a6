# SPDX-License-Identifier: BSL-1.0
"""Runs a program and measures it; whatever ends this script ends the program and what that has started."""
import contextlib
import os
import signal
import time

from storage import Failure

STOPS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
GRACE = 5  # seconds that a program has to clean up


class Stopped(BaseException):
    """By a signal."""

    def __init__(self, number):
        super().__init__(f"stopped by {signal.Signals(number).name}")
        self.number = number


def _stop(number, _):
    for other in STOPS:  # once is enough: cleaning up must not be stopped
        signal.signal(other, signal.SIG_IGN)
    raise Stopped(number)


def stop_by_exception():
    for number in STOPS:
        signal.signal(number, _stop)


@contextlib.contextmanager
def _held_back():
    before = signal.pthread_sigmask(signal.SIG_BLOCK, STOPS)
    try:
        yield before
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _is_over(process):
    try:
        return os.waitpid(process, os.WNOHANG)[0] != 0
    except ChildProcessError:
        return True


def _end(process):
    """Asks the program's group to stop, and makes it after a while."""
    for number in (signal.SIGTERM, signal.SIGKILL):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process, number)
        until = time.monotonic() + GRACE
        while time.monotonic() < until:
            if _is_over(process):
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process, signal.SIGKILL)  # what it left behind
                return
            time.sleep(0.02)


def run_program(arguments, output=None):
    """Exit status, CPU seconds and peak memory in MB of a program and of what it starts.

    The memory of this script counts as theirs where it is more, so that it keeps to the standard library.

    @param output  a file for what it prints; else where this script prints."""
    arguments = [str(a) for a in arguments]
    to_file = [(os.POSIX_SPAWN_OPEN, 1, str(output), os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)] if output else []
    process = None
    try:
        with _held_back() as before:
            process = os.posix_spawn(arguments[0], arguments, os.environ, file_actions=to_file, setpgroup=0,
                                     setsigmask=before)
        _, status, usage = os.wait4(process, 0)
    except OSError as error:
        raise Failure(f"{arguments[0]} cannot be run: {error.strerror}") from None
    except BaseException:
        if process:
            _end(process)
        raise
    return os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def find_program(path):
    """@throws Failure  when there is nothing that can be run."""
    if not path.is_file():
        raise Failure(f"there is no program {path}")
    if not os.access(path, os.X_OK):
        raise Failure(f"{path} cannot be run: it is not executable")
    return path.resolve()
