"""Camera paths that fit any cloud, in the coordinates of its box: bench/README.md describes the format.

paths.py FOLDER [FRAMES]     writes fly-over.json, walk-through.json, orbit.json and plan.json
"""
import json
import math
import pathlib
import sys


def frame(eye, target, rest, **lens):
    return {"eye": [round(v, 6) for v in eye], "target": [round(v, 6) for v in target], **lens, **({"rest": True} if rest else {})}


def resting(i, frames, stops):
    """The camera rests `stops` times, evenly, the last time at the end of the path."""
    return frames > 1 and (i + 1) * stops // frames > i * stops // frames


def fly_over(frames, stops=3):
    """From one corner to the other in three strips, looking ahead and down."""
    result = []
    for i in range(frames):
        t = i / max(1, frames - 1)
        strip = min(2, int(3 * t))
        along = 3 * t - strip
        x = (2 * along - 1) * (1 if strip % 2 == 0 else -1)
        y = -0.66 + 0.66 * strip
        ahead = 1 if strip % 2 == 0 else -1
        result.append(frame((x - 0.3 * ahead, y, 0.45), (x + 0.3 * ahead, y, 0.05), resting(i, frames, stops), angle=60))
    return result


def walk_through(frames, stops=3):
    """A figure of eight near the ground, with a look around."""
    result = []
    for i in range(frames):
        t = 2 * math.pi * i / max(1, frames)
        x, y = 0.7 * math.sin(t), 0.7 * math.sin(t) * math.cos(t)
        heading = math.atan2(math.cos(2 * t), math.cos(t)) + 0.6 * math.sin(5 * t)
        result.append(frame((x, y, 0.08), (x + math.cos(heading), y + math.sin(heading), 0.06), resting(i, frames, stops), angle=75))
    return result


def orbit(frames, stops=3):
    """Once around the whole, closing in to a detail and going away again."""
    result = []
    for i in range(frames):
        t = i / max(1, frames - 1)
        turn = 2 * math.pi * t
        away = 2.6 - 2.35 * math.sin(math.pi * t) ** 2
        target = (0.3 * math.sin(math.pi * t), 0.2 * math.sin(math.pi * t), 0.08)
        eye = (target[0] + away * math.cos(turn), target[1] + away * math.sin(turn), target[2] + 0.5 * away)
        result.append(frame(eye, target, resting(i, frames, stops), angle=45))
    return result


def plan(frames, stops=3):
    """Orthographic, from above, zooming into the middle."""
    result = []
    for i in range(frames):
        t = i / max(1, frames - 1)
        eye = (0.2 * math.sin(4 * t), 0.2 * math.sin(3 * t), 5)
        result.append({**frame(eye, (eye[0], eye[1], 0), resting(i, frames, stops), height=round(2.2 * 0.04 ** t, 6)), "up": [0, 1, 0]})
    return result


PATHS = {"fly-over": fly_over, "walk-through": walk_through, "orbit": orbit, "plan": plan}


def write(folder, frames):
    """Name: file of each path, with this number of frames."""
    folder.mkdir(parents=True, exist_ok=True)
    files = {}
    for name, make in PATHS.items():
        path = {"format": "pcm camera path", "version": 1, "name": name, "coordinates": "box", "frames": make(frames)}
        files[name] = folder / f"{name}.json"
        head = json.dumps({key: value for key, value in path.items() if key != "frames"})[:-1]
        lines = ",\n".join(" " + json.dumps(f) for f in path["frames"])
        files[name].write_text(f"{head}, \"frames\": [\n{lines}\n]}}\n")
    return files


if __name__ == "__main__":
    write(pathlib.Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 120)
