"""Picks among the points in memory, and exact ones."""
import json

from study import process

TITLE = "Picks by what is in memory"
WHAT = ("A click through a random pixel of views from all of the site to a hundredth of it: the first answer comes from the points in memory (the tree's coarse nodes first), the exact one from all "
        "points, read from disk where need be. The error is how much deeper the point is than the right one; the 95th percentile, where a ray that finds nothing counts as the site's diagonal. "
        "*Missed*: such rays. Time is that of a click, all threads together (`bench_pick`). A click first shows the answer from memory and then the exact one.")
ERROR = "95 % error of the depth, m"
EXACT = "PointPickerTest.FindsWhatALookAtEveryPointFinds"
FLOOR = 0.0


def measure(lab):
    rows = []
    for place in lab.places:
        scene = lab.scene(place)
        words = ["bench_pick", scene.tree, "--levels", "--rays", 2 * lab.size.sample]
        command = " ".join(lab.shown(str(word)) for word in words)
        turns = []
        for _ in range(lab.size.repeat):
            text, _ = process.timed([lab.bin / words[0], *words[1:]])
            turns.append([json.loads(line) for line in text.splitlines()])
        for of_setting in zip(*turns):
            first, times = of_setting[0], sorted(turn["cpu_seconds"] for turn in of_setting)
            exact = first["nodes"].startswith("exact")
            rows.append({"place": place, "program": "pcmlab, nothing in memory" if first["nodes"] == "exact, from disk" else "pcmlab", "setting": "exact" if exact else f"nodes to depth {first['nodes']}", "default": exact,
                         "cpu": times[len(times) // 2], "cpu_range": [times[0], times[-1]], "error": first["error_p95"], "missed, %": first["missed_percent"], "command": command})
    return rows


def absent(lab):
    return ["CloudCompare's and Potree's picks, which look at the points that are drawn: not installed"]
