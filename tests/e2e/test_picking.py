"""The tool Pick Point in the real window: on a real scan at map coordinates, behind a mesh, among hidden classes."""

import math
import re
import struct
import unittest

from meshlab import NO_TIME_LIMIT, MeshLabTest, pcmlab, sample

SIZE = 640, 480
PLACES = [(0.5, 0.5), (0.42, 0.55), (0.6, 0.52), (0.52, 0.45), (0.47, 0.6), (0.55, 0.58)]
TOLERANCE = 4  # pixels


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return math.fsum(x * y for x, y in zip(a, b))


def las_records(path):
    """Points of a LAS file of point format 3, read without our code: {(x, y, z): [attributes]}."""
    data = path.read_bytes()
    begin, = struct.unpack_from("<I", data, 96)
    form, length, count = struct.unpack_from("<BHI", data, 104)
    assert form == 3
    scale, offset = struct.unpack_from("<3d", data, 131), struct.unpack_from("<3d", data, 155)
    points = {}
    for i in range(count):
        x, y, z, intensity, returns, kind, angle, user, source, time, *rgb = struct.unpack_from("<3iHBBbBHd3H", data,
                                                                                                begin + i * length)
        position = tuple(q * s + o for q, s, o in zip((x, y, z), scale, offset))
        points.setdefault(position, []).append({
            "intensity": intensity, "return_number": returns & 7, "number_of_returns": returns >> 3 & 7,
            "classification": kind & 31, "scan_angle_rank": angle, "user_data": user, "point_source_id": source,
            "gps_time": time, "rgb": " ".join(map(str, rgb))})
    return points


class Camera:
    """A perspective camera as the driver's print-camera prints it; the window is SIZE large."""

    def __init__(self, printed, origin):
        eye, centre, above = (printed[name] for name in ("eye", "centre", "above"))
        self.eye = [e + o for e, o in zip(eye, origin)]
        away, up = minus(centre, eye), minus(above, centre)
        distance = math.hypot(*away)
        self.forward = [v / distance for v in away]
        self.up = [v / math.hypot(*up) for v in up]
        f, u = self.forward, self.up
        self.right = [f[1] * u[2] - f[2] * u[1], f[2] * u[0] - f[0] * u[2], f[0] * u[1] - f[1] * u[0]]
        self.tangent = 1.75 / printed["scale"] / distance  # of half the vertical angle of view

    def pixel(self, depth):
        return 2 * depth * self.tangent / SIZE[1]

    def ray(self, place):
        """The direction of what a click at these fractions of the view sees."""
        x, y = (int(fraction * size) + 0.5 for fraction, size in zip(place, SIZE))
        right, up = (2 * x / SIZE[0] - 1) * SIZE[0] / SIZE[1] * self.tangent, (1 - 2 * y / SIZE[1]) * self.tangent
        along = [f + right * r + up * u for f, r, u in zip(self.forward, self.right, self.up)]
        return [v / math.hypot(*along) for v in along]


def t_and_s(camera, direction, point):
    d = minus(point, camera.eye)
    t = dot(direction, d)
    return t, math.hypot(*(v - t * u for v, u in zip(d, direction)))


class Picking(MeshLabTest):
    def picked(self, places):
        """Driver commands that click and wait for the exact answer."""
        return "".join(f"click {x} {y}\nwait-label PickPointMessage ,\nprint-property pcm_pick\n"
                       for x, y in places)

    def answered(self, x, y):
        """The same for a click that may find no point."""
        return f'forget-property pcm_pick\nclick {x} {y}\nwait-property pcm_pick "final":true\nprint-property pcm_pick\n'

    def test_a_real_scan_at_map_coordinates(self):
        """What is picked is a point of the file with all its attributes, under the cursor, and none is nearer there."""
        scan = sample("las/autzen_trim.laz")
        las, tree = self.folder / "scan.las", self.folder / "scan.pct"
        pcmlab("convert", scan, las)
        pcmlab("build", las, "-o", tree)
        run = self.gui(f"""
            wait-view
            {NO_TIME_LIMIT}
            view-size {SIZE[0]} {SIZE[1]}
            open {tree}
            wait-layers 1
            wait-status complete
            drag 0.5 0.5 0.5 0.3
            wheel -6
            wait-status complete
            trigger Pick Point
            wait-log Pick Point: click a point
            {self.picked(PLACES)}
            print-camera picked
            wait-status complete
            screen {self.result("screen.png")}
            picture {self.result("picked.png")}
            """)
        self.assertDriven(run)
        origin = [float(v) for v in re.search(r"document's origin (\S+) (\S+) (\S+?)\.?\s", run.text).groups()]
        camera = Camera(run.cameras()["picked"], origin)
        # Steps of a hundredth, as the decimals that they are.
        points = {tuple(round(v, 2) for v in place): records for place, records in las_records(las).items()}
        answers = run.properties("pcm_pick")
        self.assertEqual(len(answers), len(PLACES))
        for place, answer in zip(PLACES, answers):
            with self.subTest(place):
                self.assertTrue(answer["final"])
                found = answer["point"]
                position = tuple(float(found[axis]) for axis in "xyz")
                self.assertIn(position, points, "every digit of the file")
                ours = [{name: type(value)(found[name]) for name, value in record.items()}
                        for record in points[position]]
                self.assertIn(True, [a == b for a, b in zip(ours, points[position])], found)
                direction = camera.ray(place)
                t, s = t_and_s(camera, direction, position)
                pixel = camera.pixel(t)
                self.assertLess(s, max(TOLERANCE * pixel, 2 * float(found["spacing of points"])) + 0.1 * pixel)
                # A point within the tolerance is hit, and its depth at the ray is at most this.
                near = (t_and_s(camera, direction, p) for p in points)
                least = min((u + v * v / (2 * TOLERANCE * camera.pixel(u)) for u, v in near
                             if v < 0.97 * TOLERANCE * camera.pixel(u)), default=math.inf)
                self.assertLess(t, least + 0.1 * pixel)

    def test_a_mesh_hides_points_and_a_click_beside_changes_nothing(self):
        _, tree = self.generate("scene", 60000, "--seed", 3, "--origin", "0,0,0")
        box = pcmlab("info", tree)["bounds"]
        low, high = box["min"], box["max"]
        middle, top = (low[0] + high[0]) / 2, high[2] + 1
        mesh = self.folder / "cover.ply"
        mesh.write_text("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                        "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
                        + "".join(f"{x} {y} {top}\n" for x, y in ((middle, low[1]), (high[0], low[1]), (high[0], high[1]),
                                                                  (middle, high[1]))) + "3 0 1 2\n3 0 2 3\n")
        run = self.gui(f"""
            wait-view
            {NO_TIME_LIMIT}
            view-size {SIZE[0]} {SIZE[1]}
            open {tree}
            wait-layers 1
            wait-status complete
            open {mesh}
            wait-layers 2
            wait-status complete
            trigger Pick Point
            wait-log Pick Point: click a point
            click 0.4 0.5
            wait-label PickPointMessage ,
            print-property pcm_pick
            click 0.6 0.5
            wait-label PickPointMessage in front of the layer
            print-property pcm_pick
            print-label PickPointMessage
            screen {self.result("covered.png")}
            show-layer 1 off
            wait-status complete
            click 0.6 0.5
            wait-label PickPointMessage ,
            print-property pcm_pick
            click 0.02 0.02
            wait-label PickPointMessage No point within 4 pixels
            print-property pcm_pick
            screen {self.result("beside.png")}
            key-down Ctrl+C
            wait-label PickPointMessage copied
            escape
            pause 200
            escape
            click 0.4 0.5
            wait-label PickPointMessage ,
            """)
        self.assertDriven(run)
        left, covered, shown, beside = run.properties("pcm_pick")
        self.assertLess(float(left["point"]["x"]), middle)
        self.assertNotIn("point", covered)
        self.assertIn("cover", covered["message"])
        self.assertGreater(float(shown["point"]["x"]), middle)
        self.assertNotIn("point", beside)

    def test_hidden_classes_are_not_picked(self):
        """Where one class hides another from above, hiding it gives what is below."""
        las, tree = self.folder / "two.las", self.folder / "two.pct"
        pcmlab("generate", "--points", 60000, "--seed", 3, "--no-truth", las)
        pcmlab("build", las, "-o", tree)
        classes = {}
        for hidden in ("", "2"):
            run = self.gui(f"""
                wait-view
                {NO_TIME_LIMIT}
                view-size {SIZE[0]} {SIZE[1]}
                open {tree}
                wait-layers 1
                parameter MeshLab::PointCloud::HiddenClasses = {hidden}
                wait-status complete
                trigger Pick Point
                wait-log Pick Point: click a point
                {"".join(self.answered(0.3 + 0.05 * i, 0.5) for i in range(8))}
                """)
            self.assertDriven(run)
            classes[hidden] = [answer["point"]["classification"] for answer in run.properties("pcm_pick")
                               if "point" in answer]
        self.assertIn("2", classes[""])
        self.assertNotIn("2", classes["2"])


if __name__ == "__main__":
    unittest.main()
