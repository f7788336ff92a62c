"""What a run was made on: sys_info.txt. Names of hosts and people are left out."""
import os
import pathlib
import platform
import subprocess
import sys


def first_line(path, starts):
    try:
        for line in pathlib.Path(path).read_text(encoding="utf-8").splitlines():
            if line.startswith(starts):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return "unknown"


def disk_kind(folder):
    """The device that holds the folder, as the kernel reports it."""
    number = os.stat(folder).st_dev
    device = pathlib.Path(f"/sys/dev/block/{os.major(number)}:{os.minor(number)}")
    if not device.exists():
        return "not a block device"
    device = device.resolve()
    if (device / "partition").exists():
        device = device.parent
    try:
        rotates = (device / "queue" / "rotational").read_text().strip() == "1"
    except OSError:
        return "unknown"
    virtual = device.name.startswith(("vd", "xvd", "zram", "dm-", "md"))
    name = device.name.rstrip("0123456789")
    return f"{name}, {'virtual: what is below is not known' if virtual else 'rotating' if rotates else 'solid state'}"


def file_system(folder):
    result = subprocess.run(["stat", "-f", "-c", "%T", str(folder)], capture_output=True, text=True, check=False)
    return result.stdout.strip() or "unknown"


def versions():
    found = [f"Python {platform.python_version()}"]
    for name in ("numpy", "matplotlib"):
        module = sys.modules.get(name)
        if module:
            found.append(f"{name} {module.__version__}")
    return ", ".join(found)


def describe(work, about, pcm_version):
    memory = first_line("/proc/meminfo", "MemTotal").split()
    lines = {
        "processor": first_line("/proc/cpuinfo", "model name"),
        "cores": f"{len(os.sched_getaffinity(0))} of {os.cpu_count()}",
        "clock, MHz": first_line("/proc/cpuinfo", "cpu MHz"),
        "cache of a core": first_line("/proc/cpuinfo", "cache size"),
        "memory": f"{int(memory[0]) / 2**20:.1f} GiB" if len(memory) == 2 else "unknown",
        "disk": f"{disk_kind(work)}; {file_system(work)}",
        "kernel": f"{platform.system()} {platform.release()} {platform.machine()}",
        "OpenGL": about["gl"] or f"none: {about.get('why_not', '')}",
        "versions": f"pcm {pcm_version}, {versions()}",
        "load when the run began": "{:.2f} {:.2f} {:.2f}".format(*os.getloadavg()),
    }
    return "".join(f"{key}: {value}\n" for key, value in lines.items())
