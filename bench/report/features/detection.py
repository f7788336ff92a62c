"""Detection of primitives by step and least points."""
import re

from study import process

TITLE = "Detection by step and least points"
WHAT = ("Planes, cylinders and spheres of the generated site, with parts that are farther apart than the step kept apart (by itself: as the spacing around each point allows), and from the given number of points on. The error is the share of true "
        "primitives of more than 500 points that are not found with at least half of their points; *false*: found ones that are no true one of their kind; *position*: the median error of the found ones. "
        "Time is that of the detection (`bench_detect`).")
ERROR = "primitives not found, %"
EXACT = ""
WANTED = 500
SETTINGS = [("as it is", ()), *((f"step {step} m", ("--step", step)) for step in (0.2, 0.4, 0.8)), *((f"from {least} points", ("--min-points", least)) for least in (50, 150, 1500))]


def judged(text):
    recall, false = re.search(r"recall ([\d.]+) %, false ([\d.]+) %", text).groups()
    position = re.search(r"position error: median ([\d.]+) mm", text)
    return {"error": 100 - float(recall), "false, %": float(false), **({"position, mm": float(position.group(1))} if position else {})}


def measure(lab):
    rows = []
    for place in lab.places:
        scene = lab.scene(place)
        for setting, options in SETTINGS:
            words = ["bench_detect", scene.tree, "--wanted", WANTED, "-t", 1, *options]
            try:
                texts = [process.timed([lab.bin / words[0], *words[1:]])[0] for _ in range(min(2, lab.size.repeat))]
            except RuntimeError as error:  # a step that cannot be: the row is left out, and said
                print(f"detection, {setting}: {error}", flush=True)
                continue
            times = sorted(float(re.search(r"processor time ([\d.]+) s", text).group(1)) for text in texts)
            rows.append({"place": place, "program": "pcmlab", "setting": setting, "default": not options, "cpu": times[0], "cpu_range": [times[0], times[-1]], **judged(texts[0]),
                         "command": " ".join(lab.shown(str(word)) for word in words)})
    return rows


def absent(lab):
    return ["CGAL's efficient RANSAC and PCL's segmentation in a loop: `bench_detect_cgal` and `bench_detect_pcl` are built where their headers are; detection.md, a chapter below, compares with them"]
