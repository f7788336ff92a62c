"""A process, timed by the kernel."""
import os
import pathlib
import subprocess
import tempfile
import time


def resident_peak(pid):
    """In KiB; 0 of a process that has ended."""
    try:
        for line in pathlib.Path(f"/proc/{pid}/status").read_text(encoding="utf-8").splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1])
    except OSError:
        pass
    return 0


def timed(command, environment=None):
    """Runs a process: its output, and what it took by the kernel's account."""
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as errors:
        process = subprocess.Popen([str(word) for word in command], stdout=out, stderr=errors, stdin=subprocess.DEVNULL,
                                   env={**os.environ, **(environment or {})})
        # The kernel's largest resident set of a child begins with that of this process: the child's own is looked up.
        pid = peak = 0
        while pid == 0:
            peak = max(peak, resident_peak(process.pid))
            time.sleep(0.01)
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        errors.seek(0)
        text = out.read()
        if process.returncode:
            raise RuntimeError(f"{command[0]} {command[1]}: {(errors.read() or text)[-500:]}")
        return text, {"cpu": usage.ru_utime + usage.ru_stime, "peak_mb": peak / 1024}
