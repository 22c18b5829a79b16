"""A child process with a time limit and a measurement of its memory."""
import subprocess
import tempfile
import time

FIRST_LOOK, LONGEST_PAUSE = 0.002, 0.05  # [s]


class Child:
    """Result of a child: exit status (None: it took too long), stderr and peak memory [bytes].

    The peak is the kernel's high-water mark of the running program, read until its end. The value of
    getrusage would be at least the size of this process when it started the child.
    """

    def __init__(self, command, time_limit=None):
        self.peak_memory = 0
        with tempfile.TemporaryFile("w+") as errors:
            with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors) as process:
                try:
                    self.status = self._watch(process, time_limit)
                finally:
                    process.kill()  # no effect if it has ended
            errors.seek(0)
            self.errors = errors.read().strip()

    def _watch(self, process, time_limit):
        end = None if time_limit is None else time.monotonic() + time_limit
        pause = FIRST_LOOK
        while True:
            try:
                return process.wait(timeout=pause)
            except subprocess.TimeoutExpired:
                self.peak_memory = max(self.peak_memory, _high_water(process.pid))
            if end is not None and time.monotonic() > end:
                return None
            pause = min(2 * pause, LONGEST_PAUSE)


def _high_water(pid):
    """VmHWM [bytes]; 0 if there is none: the process has just ended, or the system is another."""
    try:
        with open("/proc/%d/status" % pid) as stream:
            for line in stream:
                if line.startswith("VmHWM:"):
                    return 1024 * int(line.split()[1])
    except OSError:
        pass
    return 0
