# SPDX-License-Identifier: MIT
"""Programs that run side by side: started apart from the terminal, stopped with checkpoints."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

TOO_LONG = 124  # exit code of a program that took longer than its time limit


class Processes:
    """Programs that go on. `stop()` asks them all for a checkpoint, and no more is to be begun."""

    def __init__(self, limit: float = math.inf) -> None:
        self.limit = limit  # seconds of the clock that each may take
        self.stopping = threading.Event()
        self.started = 0
        self._going: set[subprocess.Popen] = set()
        self._lock = threading.Lock()

    def stop(self) -> None:
        """Ask all to write a checkpoint and end with code 75; mpirun hands it on."""
        self.stopping.set()
        with self._lock:
            for process in self._going:
                os.kill(process.pid, signal.SIGUSR2)

    def run(
        self,
        command: Sequence[str],
        log: TextIO,
        place: Path | None = None,
        environment: dict[str, str] | None = None,
        keep: tuple[int, ...] = (),
    ) -> tuple[int, float]:
        """Exit code and core-seconds of a program; over the time limit it is stopped for good.

        `keep`: file descriptors that live on in it, as those of locks do.
        """
        process = subprocess.Popen(
            command,
            cwd=place,
            env=environment,
            stdout=log,
            stderr=log,
            pass_fds=keep,
            start_new_session=True,  # Ctrl-C is for who stops them all
        )
        with self._lock:
            self.started += 1
            self._going.add(process)
            if self.stopping.is_set():
                os.kill(process.pid, signal.SIGUSR2)
        status, usage = self._end_of(process)
        code = os.waitstatus_to_exitcode(status)
        process.returncode = code
        return code if code >= 0 else 128 - code, usage.ru_utime + usage.ru_stime

    def _end_of(self, process: subprocess.Popen):
        """Status and resources of a process that has ended. Signals go by `os.kill`: those of
        `Popen` look whether it has ended, and nothing is left to wait for then.
        """
        begun = time.monotonic()
        while True:
            with self._lock:  # a process that nobody has waited for keeps its number
                pid, status, used = os.wait4(process.pid, os.WNOHANG)
                if pid:
                    self._going.discard(process)
                    return status, used
            if time.monotonic() - begun > self.limit:
                with self._lock:
                    os.kill(process.pid, signal.SIGKILL)
                    _, _, used = os.wait4(process.pid, 0)
                    self._going.discard(process)
                return TOO_LONG << 8, used
            time.sleep(min(0.05, 0.005 + 0.05 * (time.monotonic() - begun)))
