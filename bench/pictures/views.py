"""What truth.py draws, and how good it is: views, methods, figures."""
import dataclasses
import math

import numpy as np
from scipy.ndimage import distance_transform_edt, map_coordinates

import metrics

SURFACE = 1  # Kind of scenes/look.h
TURN_PX = 0.4
CONSTANT_SIZES = (1, 2, 3, 5)  # pixels: what a user of constant points chooses from
STATES = ("moving", "rest")

# Ours: the cloud's tree (with normals and radii or without) and the options of bench_pictures.
OURS = {"default": (False, []), "discs": (True, ["--splats", "perspective"])}
POTREE, CONSTANT = "Potree's rule, re-made", "CloudCompare-like"


@dataclasses.dataclass
class Size:
    points: int
    width: int
    height: int
    views: tuple = ()   # all where empty
    sizes: tuple = CONSTANT_SIZES
    approach: int = 12  # frames in which the camera arrives
    moving_points: int = 300_000  # budget of a frame; that of time is left out, so that pictures do not depend on the machine and what else it does


FULL = Size(1_000_000, 640, 480)
QUICK = Size(120_000, 320, 240, ("wall", "interior", "forest"), (1, 3), 4, 40_000)


def pixel_angle(view, height):
    return math.atan(2 * math.tan(math.radians(view["angle"]) / 2) / height)


def turned(view, pixels, height):
    """The view's camera turned to the right by so many of its pixels, about the direction that is up in the picture."""
    angle = pixels * pixel_angle(view, height)
    eye, ahead = np.array(view["eye"], float), np.array(view["target"], float) - np.array(view["eye"], float)
    right = np.cross(ahead, (0, 0, 1))
    right *= np.linalg.norm(ahead) / np.linalg.norm(right)
    up = np.cross(right, ahead)
    return {"eye": list(eye), "target": list(eye + math.cos(angle) * ahead + math.sin(angle) * right), "up": list(up / np.linalg.norm(up)), "angle": view["angle"]}


def turn_picture(picture, view, pixels):
    """What the camera, turned as above, would see if the picture were all there is: cubic interpolation; colours on black, 0 to 1."""
    height, width = picture.shape[:2]
    angle, focal = pixels * pixel_angle(view, height), height / 2 / math.tan(math.radians(view["angle"]) / 2)
    y, x = np.mgrid[:height, :width]
    u, v = (x + 0.5 - width / 2) / focal, (y + 0.5 - height / 2) / focal
    ahead = math.cos(angle) - u * math.sin(angle)
    places = [v / ahead * focal + height / 2 - 0.5, (u * math.cos(angle) + math.sin(angle)) / ahead * focal + width / 2 - 0.5]
    colours = metrics.on_black(picture)
    return np.stack([np.clip(map_coordinates(colours[:, :, c], places, order=3, mode="nearest"), 0, 1) for c in range(3)], axis=2)


def paths(of_scene, size):
    """Camera paths of one scene: its views; these and the turned ones, in turns; and that with the camera arriving at each view."""
    still, both, arriving = [], [], []
    for view in of_scene:
        pair = [turned(view, 0, size.height), turned(view, TURN_PX, size.height)]
        still.append(pair[0])
        both += pair
        arriving += [turned(view, -6 * (size.approach - i), size.height) for i in range(size.approach)] + [{**frame, "rest": True} for frame in pair]
    return tuple({"format": "pcm camera path", "version": 1, "coordinates": "source", "frames": frames} for frames in (still, both, arriving))


def turning(picture, turned_picture, view, where):
    """turn: how much these pixels change when the camera turns. swim: how much of that is not the turn: against the picture turned as a picture."""
    if not where.any():
        return {"turn": 0.0, "swim": 0.0}
    moved = np.abs(metrics.on_black(turned_picture) - turn_picture(picture, view, TURN_PX))
    return {"turn": metrics.changed(picture, turned_picture, where), "swim": float(255 * moved[where].mean())}


class Truth:
    """The true picture of a view, and which of its pixels can be asked about."""

    def __init__(self, view, colours, labels, facts):
        self.view, self.colours, self.labels = view, colours, labels
        self.asked = facts[:, :, 1] > 0  # a scanner saw it
        self.edge = metrics.outlines(labels)
        self.reach = max(4, round(12 * labels.shape[1] / 998))  # pixels: where splats of other things reach
        from_edge = distance_transform_edt(~self.edge)
        surface = (facts[:, :, 0] == SURFACE) & self.asked
        self.inside = surface & (from_edge > self.reach)
        self.beside = self.asked & ~self.inside & (from_edge <= self.reach)
        # Where nothing changes when the camera turns but a surface's own colours.
        self.flat = surface & (from_edge > 4)

    def covered(self, picture):
        return float((picture[:, :, 3] >= 128)[self.asked].mean())

    def likeness(self, picture):
        return metrics.likeness(self.colours, picture, self.asked)

    def shapes(self, labels):
        """Of a picture in labels. holes: share of the pixels inside surfaces that show something else, or nothing. spill: pixels near outlines that show
        something else than they should, for each pixel of outline: how wide things stand out, or are bitten into."""
        other = (np.abs(labels.astype(int) - self.labels.astype(int)).max(axis=2) > 12) & ((labels[:, :, 3] >= 128) | (self.labels[:, :, 3] >= 128))
        return {"holes": float(other[self.inside].mean()) if self.inside.any() else 0.0, "spill": float((other & self.beside).sum() / max(1, (self.edge & self.asked).sum() / 2))}

    def offset(self, labels):
        """By how many pixels, to the right and down, a picture in labels must be moved to be most like the truth where something is drawn: 0, 0 unless a camera is wrong."""
        def unlike(shift):
            moved = np.roll(labels, shift, axis=(1, 0))
            return (moved[:, :, :3] != self.labels[:, :, :3]).any(axis=2)[self.asked & (moved[:, :, 3] >= 128)].mean()

        return min(((x, y) for x in range(-3, 4) for y in range(-3, 4)), key=unlike)

    def own(self):
        """What of the figures the truth itself has."""
        moved = np.abs(metrics.on_black(self.colours) - turn_picture(self.colours, self.view, TURN_PX))
        return {"covered": self.covered(self.colours), "turn": float(255 * moved[self.flat].mean()) if self.flat.any() else 0.0, "swim": 0.0, "asked": float(self.asked.mean())}

    def figures(self, picture, labels, turned_picture=None):
        found = {**self.likeness(picture), **self.shapes(labels), "covered": self.covered(picture)}
        if turned_picture is not None:
            found.update(turning(picture, turned_picture, self.view, self.flat))
        return found


def oblique(info):
    """A view of a real cloud: from a corner of its box, down at 30 degrees, near enough for its points to be distinguished."""
    low, high = np.array(info["bounds"]["min"]), np.array(info["bounds"]["max"])
    middle, reach = (low + high) / 2, 0.35 * np.linalg.norm((high - low)[:2])
    return {"eye": list(middle + reach * np.array((-0.61, -0.61, 0.5))), "target": list(middle), "angle": 45}


def without_truth(view, pictures, state):
    """Figures of bench_pictures' two frames of a real cloud."""
    picture, at_rest = pictures[state][0], pictures["rest"][0]
    found = {"covered": float((picture[:, :, 3] >= 128).mean())}
    if state == "rest":
        found.update(turning(at_rest, pictures["rest"][1], view, at_rest[:, :, 3] >= 128))
        found["jolt"] = metrics.changed_share(pictures["moving"][0], at_rest) if "moving" in pictures else 0.0
    return found
