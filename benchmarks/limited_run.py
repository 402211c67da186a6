# SPDX-License-Identifier: BSL-1.0
"""Runs a program with limits; for the campaigns."""
import os
import resource
import signal
import subprocess
import tempfile
import typing


class Outcome(typing.NamedTuple):
    status: int | None  # None: not done in the time
    lines: list[str]  # that it said on stderr
    seconds: float  # of the processor: a busy machine makes no surface hang
    megabytes: float  # the most


def limited_run(command, seconds, gigabytes=None):
    def limits():
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
        if gigabytes:
            resource.setrlimit(resource.RLIMIT_AS, (int(gigabytes * 2**30),) * 2)

    with tempfile.TemporaryFile("w+", errors="replace") as told:
        child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=told, preexec_fn=limits)
        _, code, usage = os.wait4(child.pid, 0)
        told.seek(0)
        lines = told.read().strip().splitlines()
    status = os.waitstatus_to_exitcode(code)
    if status in (-signal.SIGXCPU, -signal.SIGKILL):
        status = None
    return Outcome(status, lines, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)
