"""Navigation in MeshLab: walking through a scene, orbiting about a picked point, both projections, full screen."""

import math
import re
import unittest

from meshlab import FIXED_VIEW, MeshLabTest, different

# The same camera gives the same picture, but for a few pixels where the angle of view is rounded differently.
SAME_PICTURE = 0.002


def distance(a, b):
    return math.dist(a, b)


def direction(camera):
    length = distance(camera["eye"], camera["centre"])
    return [(c - e) / length for e, c in zip(camera["eye"], camera["centre"])]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


class Navigation(MeshLabTest):
    def test_walk(self):
        """Start, walk, look around, end: starting and ending do not move the picture, and each key does what the help says."""
        _, tree = self.generate("scene", 200000, "--seed", 5)
        pictures = {name: self.result(f"{name}.png") for name in
                    ("before", "inside", "walked", "looked", "outside", "orbited", "ortho", "ortho-walked")}
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            drag 0.5 0.5 0.5 0.2
            wait-status complete
            picture {pictures["before"]}
            print-camera before
            trigger First Person Navigation
            wait-log First Person Navigation: W A S D
            print-camera inside
            wait-status complete
            picture {pictures["inside"]}
            key-down W
            wait-moving
            pause 300
            key-repeat W
            key-repeat W
            key-up W
            wait-standing
            wait-status complete
            print-camera walked
            picture {pictures["walked"]}
            screen {self.result("screen.png")}
            key-down D
            key-down E
            wait-moving
            print-camera two-keys
            pause 200
            key-up D
            print-camera one-key
            key-up E
            wait-standing
            print-camera aside
            wheel 3
            print-camera faster
            drag 0.4 0.5 0.5 0.45
            wait-standing
            wait-status complete
            print-camera looked
            picture {pictures["looked"]}
            key-down Shift+S
            wait-moving
            print-camera shift
            lose-focus
            print-camera lost
            wait-standing
            pause 100
            print-camera still
            pause 200
            print-camera still-later
            wait-status complete
            picture {self.result("left-behind.png")}
            trigger First Person Navigation
            pause 100
            print-camera outside
            wait-status complete
            picture {pictures["outside"]}
            drag 0.5 0.5 0.6 0.5
            wait-status complete
            print-camera orbited
            picture {pictures["orbited"]}
            trigger Reset Trackball
            trigger First Person Navigation
            wheel 10
            key-down Q
            pause 4000
            print-camera above-ground
            print-property pcm_first_person
            key-up Q
            wait-standing
            key-down G
            key-up G
            key-down Q
            pause 4000
            key-up Q
            wait-standing
            print-camera below-ground
            print-property pcm_first_person
            """)
        self.assertDriven(run)
        c = run.cameras()
        # Starting and ending the tool leaves the camera unchanged to the last bit.
        for before, after in (("before", "inside"), ("still-later", "outside")):
            for key in ("eye", "centre", "above", "scale", "near"):
                self.assertEqual(c[before][key], c[after][key], f"{key} {after}")
        self.assertEqual(different(pictures["before"], pictures["inside"]), 0)
        self.assertEqual(different(self.result("left-behind.png"), pictures["outside"]), 0)
        # Straight down, the eye stops above the ground (tests/view has where that is), until G lets it through.
        above, below = run.properties("pcm_first_person")
        self.assertEqual((above["stays_above"], below["stays_above"]), (True, False))
        self.assertGreater(c["above-ground"]["eye"][2], above["ground"])
        self.assertLess(c["above-ground"]["eye"][2], above["ground"] + 10)
        self.assertLess(c["below-ground"]["eye"][2], above["ground"])
        # W walks along the view direction, per second by the distance of the nearest points; auto-repeat changes nothing.
        ahead = direction(c["inside"])
        way = [b - a for a, b in zip(c["inside"]["eye"], c["walked"]["eye"])]
        length = math.hypot(*way)
        self.assertGreater(length, 0)
        self.assertAlmostEqual(dot(way, ahead) / length, 1, places=3)
        self.assertGreater(c["walked"]["reach"], 0)
        self.assertLessEqual(c["walked"]["reach_error"], c["walked"]["reach"])
        self.assertEqual(c["walked"]["keys"], 0)
        self.assertGreater(different(pictures["inside"], pictures["walked"]), 0.05)
        # The near plane is nearer than the nearest points, so nothing is clipped.
        near = c["walked"]["near"] / c["walked"]["scale"]
        self.assertLess(near, 0.4 * c["walked"]["reach"])
        # Two keys at once; one is released, the other still held.
        self.assertEqual(bin(c["two-keys"]["keys"]).count("1"), 2)
        self.assertEqual(bin(c["one-key"]["keys"]).count("1"), 1)
        self.assertTrue(c["one-key"]["moving"])
        way = [b - a for a, b in zip(c["walked"]["eye"], c["aside"]["eye"])]
        self.assertGreater(way[2], 0, "E goes up")
        # The wheel changes only the speed.
        self.assertAlmostEqual(c["faster"]["factor"] / c["aside"]["factor"], 1.25 ** 3, places=6)
        self.assertEqual(c["faster"]["eye"], c["aside"]["eye"])
        # Looking around rotates the view about the eye and levels the horizon.
        self.assertLess(distance(c["looked"]["eye"], c["faster"]["eye"]), 1e-3)
        self.assertLess(dot(direction(c["looked"]), direction(c["faster"])), 0.999)
        self.assertAlmostEqual(c["looked"]["roll"], 0, places=6)
        self.assertGreater(different(pictures["walked"], pictures["looked"]), 0.05)
        # A view that loses the keyboard focus stops, even if a key was held.
        self.assertEqual(bin(c["shift"]["keys"]).count("1"), 2)
        self.assertEqual(c["lost"]["keys"], 0)
        self.assertEqual(c["still"]["eye"], c["still-later"]["eye"])
        self.assertGreater(distance(c["looked"]["eye"], c["still"]["eye"]), 0)
        # The trackball starts from this camera and rotates about the point in front of the eye.
        self.assertLess(distance(c["outside"]["centre"], c["orbited"]["centre"]), 1e-3 * distance(c["outside"]["eye"], c["outside"]["centre"]))
        self.assertGreater(different(pictures["outside"], pictures["orbited"]), 0.02)

    def test_projections_and_full_screen(self):
        """The projection and full screen can be switched while walking."""
        _, tree = self.generate("scene", 100000, "--seed", 5)
        ortho, walked, perspective = (self.result(f"{name}.png") for name in ("ortho", "ortho-walked", "perspective"))
        run = self.gui(f"""
            wait-view
            open {tree}
            wait-layers 1
            {FIXED_VIEW}
            drag 0.5 0.5 0.5 0.2
            trigger First Person Navigation
            wait-log First Person Navigation: W A S D
            print-camera perspective
            trigger Toggle Orthographic Camera
            pause 100
            wait-status complete
            print-camera ortho
            picture {ortho}
            key-down W
            wait-moving
            pause 200
            key-up W
            wait-standing
            print-camera zoomed
            key-down A
            wait-moving
            pause 100
            key-up A
            wait-standing
            drag 0.5 0.5 0.55 0.5
            wait-standing
            print-camera turned
            wait-status complete
            picture {walked}
            trigger Toggle Orthographic Camera
            pause 100
            key-down Alt+Return
            key-up Alt+Return
            wait-full-screen on
            print-camera full
            wait-status complete
            key-down W
            wait-moving
            pause 100
            key-up W
            wait-standing
            print-camera full-walked
            wait-status complete
            picture {perspective}
            screen {self.result("full-screen.png")}
            trigger FullScreen
            wait-full-screen off
            trigger Not editing
            pause 100
            drag 0.5 0.5 0.6 0.5
            print-camera suspended
            trigger Not editing
            pause 100
            key-down S
            wait-moving
            pause 100
            key-up S
            wait-standing
            print-camera resumed
            trigger First Person Navigation
            pause 100
            """)
        self.assertDriven(run)
        c = run.cameras()
        self.assertEqual([c[name]["orthographic"] for name in ("perspective", "ortho", "zoomed", "turned", "full")],
                         [False, True, True, True, False])
        # In an orthographic view W magnifies about the centre of the picture; looking around keeps the centre.
        self.assertGreater(c["zoomed"]["scale"], 1.05 * c["ortho"]["scale"])
        size = distance(c["zoomed"]["eye"], c["zoomed"]["centre"])
        self.assertLess(distance(c["zoomed"]["centre"], c["ortho"]["centre"]), 1e-4 * size)
        self.assertLess(dot(direction(c["turned"]), direction(c["zoomed"])), 0.999)
        self.assertGreater(different(ortho, walked), 0.05)
        self.assertTrue(c["full"]["full_screen"])
        self.assertFalse(c["suspended"]["full_screen"])
        self.assertGreater(distance(c["full"]["eye"], c["full-walked"]["eye"]), 0)
        # The trackball moved the eye while the tool was suspended; the tool then walked backwards from there.
        self.assertGreater(distance(c["full-walked"]["eye"], c["suspended"]["eye"]), 0)
        way = [b - a for a, b in zip(c["suspended"]["eye"], c["resumed"]["eye"])]
        self.assertGreater(math.hypot(*way), 0)
        self.assertAlmostEqual(dot(way, direction(c["suspended"])) / math.hypot(*way), -1, places=2)

    def test_meshes(self):
        """Walking around a mesh without clouds: the speed depends on its box, and y is up until U is pressed."""
        mesh = self.folder / "mesh.ply"
        mesh.write_text("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                        "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
                        "0 0 0\n10 0 0\n10 10 0\n0 10 0\n3 0 1 2\n3 0 2 3\n")
        run = self.gui(f"""
            wait-view
            open {mesh}
            wait-layers 1
            print-camera opened
            trigger First Person Navigation
            wait-log (now y)
            pause 100
            print-layers
            key-down W
            wait-moving
            pause 150
            key-up W
            wait-standing
            print-camera walked
            key-down E
            wait-moving
            pause 100
            key-up E
            wait-standing
            print-camera above
            key-down U
            key-up U
            wait-log z is up
            key-down PgUp
            wait-moving
            pause 100
            key-up PgUp
            wait-standing
            print-camera nearer
            trigger First Person Navigation
            trigger Delete Current Mesh
            wait-layers 0
            trigger First Person Navigation
            key-down W
            pause 50
            key-up W
            trigger First Person Navigation
            pause 50
            """)
        self.assertDriven(run)
        c = run.cameras()
        self.assertEqual([layer["modified"] for layer in run.layers()], [False])
        # Straight towards the centre of the square, by the distance of its plane.
        self.assertLess(c["walked"]["eye"][2], c["opened"]["eye"][2])
        self.assertGreater(c["walked"]["eye"][2], 0)
        self.assertTrue(c["walked"]["eye"][2] - 0.01 <= c["walked"]["reach"] <= c["opened"]["eye"][2] + 0.01, c["walked"])
        # E moves along y, and then along z.
        self.assertGreater(c["above"]["eye"][1], c["walked"]["eye"][1])
        self.assertAlmostEqual(c["above"]["eye"][2], c["walked"]["eye"][2], delta=1e-3)
        self.assertGreater(c["nearer"]["eye"][2], c["above"]["eye"][2])
        self.assertAlmostEqual(c["nearer"]["eye"][1], c["above"]["eye"][1], delta=1e-3)

    def test_orbit_about_the_picked_point(self):
        """A double click makes the point under the mouse the centre of rotation, also at map coordinates."""
        picked = {}
        for name, origin in (("near", "0,0,0"), ("far", "5000000,5000000,5000000")):
            _, tree = self.generate(name, 200000, "--seed", 7, "--origin", origin)
            run = self.gui(f"""
                wait-view
                {FIXED_VIEW}
                parameter MeshLab::PointCloud::SplatSize = 6
                open {tree}
                wait-layers 1
                wait-status complete
                drag 0.5 0.5 0.5 0.25
                wait-status complete
                print-camera before
                picture {self.result(f"{name}-before.png")}
                misdirect-double-click
                double-click 0.45 0.55
                wait-log Recentering on point
                wait-status complete
                print-camera centred
                picture {self.result(f"{name}-centred.png")}
                drag 0.5 0.5 0.65 0.5
                wait-status complete
                print-camera orbited
                picture {self.result(f"{name}-orbited.png")}
                print-log
                """)
            self.assertDriven(run)
            c = run.cameras()
            point = [float(v) for v in re.search(r"Recentering on point \[(\S+) (\S+) (\S+)\]", run.text).groups()]
            size = distance(c["before"]["eye"], c["before"]["centre"])
            # MeshLab unprojects the depth under the mouse. This point becomes the centre of rotation and stays it.
            self.assertGreater(distance(point, c["before"]["centre"]), 0.01 * size)
            self.assertLess(distance(c["centred"]["centre"], point), 1e-3 * size)
            self.assertLess(distance(c["orbited"]["centre"], c["centred"]["centre"]), 1e-4 * size)
            self.assertGreater(distance(c["orbited"]["eye"], c["centred"]["eye"]), 0.05 * size)
            picked[name] = point
        # Both clouds have the same points, shown relative to origins in whole units. So the same point was picked, up to the
        # single precision of depth and position (millimetres here).
        for near, far in zip(picked["near"], picked["far"]):
            self.assertAlmostEqual(near - far, round(near - far), delta=0.005)


if __name__ == "__main__":
    unittest.main()
