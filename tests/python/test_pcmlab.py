"""The module pcmlab against numpy: what it returns is compared with the arrays that the cloud was made of."""

import ast
import inspect
import os
import pathlib
import resource
import sys
import tempfile
import threading
import unittest
import warnings

import with_numpy  # noqa: F401 isort: skip
import numpy
import pcmlab

TYPES = ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"]


class CloudTest(unittest.TestCase):
    """A cloud of 60,000 points with three decimals, whose attribute `id` is the row that a point was made of."""

    points = 60_000

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        chance = numpy.random.default_rng(7)
        cls.xyz = (chance.random((cls.points, 3)) * [100, 100, 10]).round(3) + [500000, 4800000, 90]
        cls.xyz = cls.xyz.round(3)
        cls.attributes = {"id": numpy.arange(cls.points, dtype="u4"),
                          "classification": chance.integers(0, 8, cls.points).astype("u1"),
                          "height": (chance.random(cls.points) * 9).astype("f4"),
                          "rgb": chance.integers(0, 65536, (cls.points, 3)).astype("u2")}
        cls.cloud = pcmlab.from_arrays(cls.path("cloud.pct"), cls.xyz, cls.attributes)

    @classmethod
    def tearDownClass(cls):
        del cls.cloud
        cls.folder.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    def same_points(self, found, mask):
        """`found` has exactly the points of the mask, with their positions and values."""
        ids = found["id"]
        self.assertEqual(sorted(ids), sorted(numpy.flatnonzero(mask)))
        numpy.testing.assert_array_equal(found["xyz"], self.xyz[ids])
        for name, values in self.attributes.items():
            if name in found:
                self.assertEqual(found[name].dtype, values.dtype)
                numpy.testing.assert_array_equal(found[name], values[ids])


class Arrays(CloudTest):
    def test_every_type_comes_back_bit_for_bit(self):
        chance = numpy.random.default_rng(3)
        n = 5000
        values = {}
        for kind in TYPES:
            for components in (1, 2, 5):
                raw = chance.bytes(n * components * numpy.dtype(kind).itemsize)
                array = numpy.frombuffer(raw, kind).reshape((n, components) if components > 1 else (n,))
                values[f"{kind}_{components}"] = array
        cloud = pcmlab.from_arrays(self.path("types.pct"), self.xyz[:n], values, id=numpy.arange(n, dtype="u8"))
        found = cloud.query()
        for name, array in values.items():
            self.assertEqual(found[name].dtype, array.dtype, name)
            self.assertEqual(found[name].shape, array.shape, name)
            self.assertEqual(found[name].tobytes(), array[found["id"]].tobytes(), name)

    def test_floats_of_single_precision_come_back_as_they_were(self):
        xyz = numpy.random.default_rng(4).normal(0, 1000, (4000, 3)).astype("f4")
        cloud = pcmlab.from_arrays(self.path("single.pct"), xyz, id=numpy.arange(4000))
        found = cloud.query()
        self.assertEqual(found["xyz"].dtype, "f8")
        numpy.testing.assert_array_equal(found["xyz"], xyz[found["id"]])

    def test_other_byte_orders_and_strides(self):
        n = 1000
        values = numpy.arange(2 * n, dtype=">i4")[::2]
        cloud = pcmlab.from_arrays(self.path("strides.pct"), numpy.asfortranarray(self.xyz[:n]), value=values)
        self.assertEqual(sorted(cloud.query()["value"]), sorted(values))

    def test_what_no_cloud_can_be_made_of_is_refused(self):
        xyz = self.xyz[:10]
        for wrong in (xyz[:, :2], xyz[0], numpy.zeros((0,))):
            with self.assertRaisesRegex(ValueError, r"\(points, 3\)"):
                pcmlab.from_arrays(self.path("wrong.pct"), wrong)
        with self.assertRaisesRegex(ValueError, "10 points"):
            pcmlab.from_arrays(self.path("wrong.pct"), xyz, a=numpy.zeros(9))
        for wrong in (numpy.array(["a"] * 10), numpy.zeros(10, complex), numpy.zeros(10, "f2")):
            with self.assertRaisesRegex(ValueError, "cannot be kept"):
                pcmlab.from_arrays(self.path("wrong.pct"), xyz, a=wrong)
        with self.assertRaises(pcmlab.Error) as caught:
            pcmlab.from_arrays(self.path("cloud.pct"), xyz)
        self.assertEqual(caught.exception.code, "exists")
        self.assertFalse(os.path.exists(self.path("wrong.pct")))

    def test_arrays_are_writable_and_outlive_the_cloud(self):
        found = pcmlab.from_arrays(self.path("gone.pct"), self.xyz[:100], a=numpy.arange(100)).query()
        found["xyz"] += 1
        found["a"][:] = 5
        self.assertEqual(found["a"].sum(), 500)


class Queries(CloudTest):
    def test_all_points(self):
        self.same_points(self.cloud.query(), numpy.ones(self.points, bool))
        self.assertEqual(self.cloud.points, self.points)
        numpy.testing.assert_array_equal(self.cloud.bounds, [self.xyz.min(0), self.xyz.max(0)])
        self.assertEqual([a.name for a in self.cloud.attributes], list(self.attributes))
        self.assertIn("60,000 points", repr(self.cloud))
        self.assertEqual(self.cloud.levels[-1], (self.points, 0))

    def test_boxes_spheres_and_polygons(self):
        low, high = self.xyz[17], self.xyz[17] + [30, 40, 5]
        box = (self.xyz >= low).all(1) & (self.xyz <= high).all(1)
        self.assertTrue(0 < box.sum() < self.points)
        self.same_points(self.cloud.query(box=(*low, *high)), box)
        self.same_points(self.cloud.query(box=[low, high]), box)
        centre = numpy.array([500040, 4800050, 95.])
        sphere = ((self.xyz - centre) ** 2).sum(1) <= 144
        self.same_points(self.cloud.query(sphere=(*centre, 12)), sphere)
        self.same_points(self.cloud.query(sphere=(centre, 12), box=[low, high]), sphere & box)
        x, y = self.xyz[:, 0] - 500000, self.xyz[:, 1] - 4800000
        triangle = (x + y < 80) & (x >= 10) & (y >= 20)
        corners = numpy.array([[10, 20], [60, 20], [10, 70]]) + [500000, 4800000]
        edge = numpy.abs(x + y - 80) < 1e-9
        found = self.cloud.query(polygon=corners)
        self.assertEqual(set(found["id"]) - set(numpy.flatnonzero(edge)), set(numpy.flatnonzero(triangle & ~edge)))

    def test_conditions(self):
        ground = numpy.isin(self.attributes["classification"], [2, 6])
        self.same_points(self.cloud.query(where="classification=2,6"), ground)
        low = self.xyz[:, 2] < 95
        self.same_points(self.cloud.query(where=["classification=2,6", "z<95"]), ground & low)

    def test_attributes_are_those_asked_for(self):
        self.assertEqual(list(self.cloud.query(attributes=["rgb", "id"], level=0)), ["xyz", "rgb", "id"])
        self.assertEqual(list(self.cloud.query(attributes=[], level=0)), ["xyz"])
        self.assertEqual(list(self.cloud.query(attributes="height", level=0, ids=True)), ["xyz", "height", "node", "number"])
        with self.assertRaisesRegex(pcmlab.Error, "nix"):
            self.cloud.query(attributes=["nix"])

    def test_levels_are_additive(self):
        before = 0
        for number, level in enumerate(self.cloud.levels):
            found = self.cloud.query(level=number)
            self.assertEqual(len(found["xyz"]), level.points)
            self.assertGreater(level.points, before)
            before = level.points

    def test_chunks_are_the_same_points(self):
        chunks = list(self.cloud.chunks(where="z<95"))
        self.assertGreater(len(chunks), 2)
        whole = self.cloud.query(where="z<95")
        for name in whole:
            numpy.testing.assert_array_equal(numpy.concatenate([chunk[name] for chunk in chunks]), whole[name])

    def test_no_points(self):
        found = self.cloud.query(box=(0, 0, 0, 1, 1, 1))
        self.assertEqual(found["xyz"].shape, (0, 3))
        self.assertEqual(found["rgb"].shape, (0, 3))
        self.assertEqual(list(self.cloud.chunks(box=(0, 0, 0, 1, 1, 1))), [])

    def test_impossible_questions(self):
        for wrong in ({"box": (1, 0, 0, 0, 1, 1)}, {"box": (0, 0, 0, 1)}, {"where": "height"}, {"region": "ball 0 0 0 1"}):
            with self.assertRaises(pcmlab.Error, msg=str(wrong)):
                self.cloud.query(**wrong)
        with self.assertRaises(pcmlab.ArgumentError):
            self.cloud.query(region="sphere 0 0 0 1", sphere=(0, 0, 0, 1))

    def test_the_estimate_holds(self):
        box = [self.xyz.min(0), self.xyz.min(0) + 30]
        estimate = self.cloud.estimate(box=box)
        found = len(self.cloud.query(box=box)["xyz"])
        self.assertLessEqual(estimate["points_least"], found)
        self.assertGreaterEqual(estimate["points_most"], found)

    def test_scaled_values(self):
        found = self.cloud.query(scaled=True)
        self.assertEqual(found["rgb"].dtype, "f8")
        numpy.testing.assert_array_equal(found["rgb"], self.attributes["rgb"][found["id"].astype(int)])


class Searches(CloudTest):
    def test_nearest_points_are_those_of_brute_force(self):
        places = numpy.random.default_rng(5).random((40, 3)) * [100, 100, 10] + [500000, 4800000, 90]
        found = self.cloud.nearest(places, 6)
        self.assertEqual(found["error"], 0)
        for i, place in enumerate(places):
            squares = ((self.xyz - place) ** 2).sum(1)
            expected = numpy.sqrt(numpy.sort(squares)[:6])
            numpy.testing.assert_allclose(found["distance"][i], expected, rtol=1e-12)
            numpy.testing.assert_allclose(numpy.linalg.norm(found["xyz"][i] - place, axis=1), expected, rtol=1e-9)
        values = self.cloud.values(found["node"], found["number"], ["id"])
        numpy.testing.assert_array_equal(values["xyz"].reshape(-1, 6, 3), found["xyz"])
        numpy.testing.assert_array_equal(self.xyz[values["id"]], values["xyz"])

    def test_one_place_and_too_few_points(self):
        found = self.cloud.nearest(self.xyz[3], 2, max_distance=0)
        self.assertEqual(found["distance"].tolist(), [0, float("inf")])
        numpy.testing.assert_array_equal(found["xyz"][0], self.xyz[3])
        self.assertTrue(numpy.isnan(found["xyz"][1]).all())
        with self.assertRaises(ValueError):
            self.cloud.nearest([[1, 2]], 1)

    def test_ids_name_points(self):
        found = self.cloud.query(ids=True, where="z<93")
        order = numpy.random.default_rng(6).permutation(len(found["id"]))
        values = self.cloud.values(found["node"][order], found["number"][order])
        for name in ("xyz", "rgb", "id", "height"):
            numpy.testing.assert_array_equal(values[name], found[name][order])
        with self.assertRaisesRegex(pcmlab.Error, "no point"):
            self.cloud.values([10**6], [0])
        with self.assertRaises(KeyError):
            self.cloud.values([0], [0], ["nix"])
        with self.assertRaises(ValueError):
            self.cloud.values([0, 0], [0])
        self.assertEqual(self.cloud.values([], [], ["rgb"])["rgb"].shape, (0, 3))


class Changes(CloudTest):
    def fresh(self, name, **attributes):
        pcmlab.from_arrays(self.path(name), self.xyz[:20_000], id=numpy.arange(20_000, dtype="u4"), **attributes)
        return self.path(name)

    def test_changes_are_in_the_tree_after_the_block(self):
        path = self.fresh("changed.pct", level=numpy.zeros(20_000, "i2"))
        with pcmlab.edit(path) as cloud:
            cloud.add_attribute("above", "f4")
            cloud.add_attribute("pair", "u1", 2)
            for chunk in cloud.changes(where="z<95", attributes=["above", "pair", "level", "id"]):
                chunk["above"] = chunk["xyz"][:, 2] - 92
                chunk["pair"] = [3, 4]
                chunk["level"] = numpy.where(chunk["id"] % 2, -7, 7)
                numpy.testing.assert_array_equal(chunk["level"], numpy.where(chunk["id"] % 2, -7, 7))
        found = pcmlab.open(path).query()
        low = self.xyz[found["id"], 2] < 95
        expected = numpy.where(low, self.xyz[found["id"], 2] - 92, 0).astype("f4")
        numpy.testing.assert_array_equal(found["above"], expected)
        numpy.testing.assert_array_equal(found["pair"], numpy.where(low[:, None], [3, 4], 0))
        numpy.testing.assert_array_equal(found["level"], numpy.where(low, numpy.where(found["id"] % 2, -7, 7), 0))

    def test_a_chunk_has_the_values_of_a_query_for_values_of_any_size(self):
        numbers = numpy.random.default_rng(8)
        sizes = {f"{kind}_{components}": numbers.integers(0, 100, (20_000, components)).astype(kind)
                 for kind in ("u1", "i2", "f4", "f8") for components in (1, 2, 3)}
        path = self.fresh("sizes.pct", **sizes)
        expected = pcmlab.open(path).query(where="z<95")
        with pcmlab.edit(path) as cloud:
            found = [{name: chunk[name] for name in chunk.keys()} for chunk in cloud.changes(where="z<95")]
        self.assertLess(len(expected["id"]), 20_000)
        self.assertEqual(sorted(found[0]), sorted(expected))
        for name, values in expected.items():
            numpy.testing.assert_array_equal(numpy.concatenate([chunk[name] for chunk in found]), values, name)
            self.assertEqual(found[0][name].dtype, values.dtype)

    def test_an_exception_leaves_nothing(self):
        path = self.fresh("kept.pct", value=numpy.ones(20_000, "u1"))
        with self.assertRaisesRegex(RuntimeError, "stop"):
            with pcmlab.edit(path) as cloud:
                for chunk in cloud.changes():
                    chunk["value"] = 9
                raise RuntimeError("stop")
        self.assertEqual(set(pcmlab.open(path).query()["value"]), {1})
        with pcmlab.edit(path):  # the lock was released
            pass

    def test_a_value_that_the_type_cannot_hold_changes_nothing(self):
        path = self.fresh("range.pct", value=numpy.ones(20_000, "u1"))
        with pcmlab.edit(path) as cloud:
            for chunk in cloud.changes():
                for wrong in (256, -1, 0.5, numpy.arange(len(chunk)) / 2):
                    with self.assertRaises(pcmlab.Error):
                        chunk["value"] = wrong
                with self.assertRaises(ValueError):
                    chunk["value"] = [1, 2]
                with self.assertRaises(KeyError):
                    chunk["nix"] = 1
                with self.assertRaises(KeyError):
                    chunk["xyz"] = 1
        self.assertEqual(set(pcmlab.open(path).query()["value"]), {1})

    def test_a_chunk_that_was_left_is_refused(self):
        path = self.fresh("left.pct", value=numpy.ones(20_000, "u1"))
        with pcmlab.edit(path) as cloud:
            chunks = list(cloud.changes())
            with self.assertRaisesRegex(pcmlab.Error, "left"):
                chunks[0]["value"] = 3

    def test_a_second_writer_is_refused_and_readers_keep_their_points(self):
        path = self.fresh("shared.pct", value=numpy.ones(20_000, "u1"))
        reader = pcmlab.open(path)
        with pcmlab.edit(path) as cloud:
            with self.assertRaises(pcmlab.Error) as caught:
                with pcmlab.edit(path):
                    pass
            self.assertEqual(caught.exception.code, "exists")
            for chunk in cloud.changes():
                chunk["value"] = 2
        self.assertEqual(set(reader.query()["value"]), {1})
        self.assertEqual(set(pcmlab.open(path).query()["value"]), {2})
        with self.assertRaises(AttributeError):
            reader.changes()


class Operations(CloudTest):
    def test_a_filter_is_the_same_as_in_numpy(self):
        answer = pcmlab.select(self.path("cloud.pct"), box=[*self.xyz.min(0), *(self.xyz.min(0) + 20)],
                               extract=self.path("selected.pct"))
        inside = (self.xyz <= self.xyz.min(0) + 20).all(1)
        self.assertEqual(answer["points"], inside.sum())
        self.same_points(pcmlab.open(self.path("selected.pct")).query(), inside)

    def test_a_file_goes_in_and_out(self):
        made = pcmlab.convert([self.path("cloud.pct")], output=self.path("cloud.ply"))
        self.assertEqual(made["points"], self.points)
        built = pcmlab.build([pathlib.Path(self.path("cloud.ply"))], output=pathlib.Path(self.path("again.pct")))
        self.assertEqual((built["points"], built["command"]), (self.points, "build"))
        self.same_points(pcmlab.open(self.path("again.pct")).query(), numpy.ones(self.points, bool))
        self.assertIn("60,000 points", str(built))
        self.assertTrue(pcmlab.verify(self.path("again.pct")).good)

    def test_damage_is_reported(self):
        pcmlab.from_arrays(self.path("damaged.pct"), self.xyz)
        data = max(pathlib.Path(self.path("damaged.pct")).iterdir(), key=lambda file: file.stat().st_size)
        content = bytearray(data.read_bytes())
        content[len(content) // 2] ^= 255
        data.write_bytes(content)
        self.assertFalse(pcmlab.verify(self.path("damaged.pct")).good)

    def test_every_operation_is_described(self):
        self.assertGreater(len(pcmlab.operations.rows), 20)
        for row in pcmlab.operations.rows:
            function = getattr(pcmlab, row["name"])
            document = inspect.getdoc(function)
            for argument in row["arguments"]:
                self.assertIn(pcmlab.operations._name(argument["key"]) + ": ", document, row["name"])
                self.assertIn(pcmlab.operations._name(argument["key"]), inspect.signature(function).parameters)
            for result in row["results"]:
                self.assertIn(result["key"], document, row["name"])

    def test_a_chain_runs_in_the_order_of_its_arguments(self):
        made = pcmlab.run(self.path("cloud.pct"), transform=(0, 0, 1), delete="classification=2,6", output=self.path("chain.pct"),
                          set=["height=1", {"values": "height=2", "where": "classification=3"}])
        self.assertEqual([step["operation"] for step in made["steps"]], ["transform", "delete", "set", "set"])
        classes = self.attributes["classification"]
        kept = (classes != 2) & (classes != 6)
        found = pcmlab.open(self.path("chain.pct")).query()
        self.assertEqual(made["points"], kept.sum())
        self.assertEqual(sorted(found["id"]), sorted(numpy.flatnonzero(kept)))
        numpy.testing.assert_allclose(found["xyz"][:, 2], self.xyz[found["id"], 2] + 1, atol=1e-9)
        numpy.testing.assert_array_equal(found["height"], numpy.where(classes[found["id"]] == 3, 2, 1))
        other = pcmlab.run(self.path("cloud.pct"), set="classification=2", delete="classification=2,6", output=self.path("none.pct"))
        self.assertEqual(other["points"], 0)

    def test_a_step_is_named_where_it_fails(self):
        def run(**steps):
            return pcmlab.run(self.path("cloud.pct"), output=self.path("o.pct"), **steps)

        with self.assertRaisesRegex(pcmlab.ArgumentError, "step 2, outliers neighbours=0: neighbours"):
            run(normals={"neighbours": 8, "confidence": False, "radii": True}, outliers={"neighbours": 0})
        with self.assertRaisesRegex(pcmlab.ArgumentError, "outliers has no argument neighbors"):
            run(outliers={"neighbors": 8})
        with self.assertRaisesRegex(pcmlab.Error, "step 1, delete nothing=3: .*no attribute"):
            run(delete="nothing=3")
        self.assertFalse(os.path.exists(self.path("o.pct")))

    def test_wrong_arguments_are_named(self):
        with self.assertRaisesRegex(pcmlab.ArgumentError, "neighbours.*1 to 1024"):
            pcmlab.outliers(self.path("cloud.pct"), output=self.path("o.pct"), neighbours=0)
        with self.assertRaises(pcmlab.ArgumentError):
            pcmlab.outliers(self.path("cloud.pct"))
        with self.assertRaises(TypeError):
            pcmlab.outliers(self.path("cloud.pct"), neighbors=3)
        with self.assertRaisesRegex(pcmlab.ArgumentError, "neither"):
            pcmlab.outliers(self.path("cloud.pct"), output=self.path("o.pct"), neighbours=object())
        self.assertFalse(os.path.exists(self.path("o.pct")))

    def test_a_switch_that_is_on_can_be_switched_off(self):
        switches = [(row, a) for row in pcmlab.operations.rows for a in row["arguments"] if a["on"]]
        self.assertTrue(switches)
        for row, argument in switches:
            parameter = inspect.signature(getattr(pcmlab, row["name"])).parameters[pcmlab.operations._name(argument["key"])]
            self.assertIs(parameter.default, True)


class Calls(CloudTest):
    def test_progress_is_called_and_can_cancel(self):
        seen = []
        self.assertEqual(len(self.cloud.query(progress=lambda *now: seen.append(now))["id"]), self.points)
        self.assertTrue(seen)
        self.assertEqual(seen[-1][0], 1)
        with self.assertRaises(pcmlab.Error) as caught:
            self.cloud.query(progress=lambda fraction, stage: False)
        self.assertEqual(caught.exception.code, "cancelled")

    def test_what_the_callback_raises_is_raised(self):
        class Mine(Exception):
            pass

        def fail(fraction, stage):
            raise Mine("here")

        for call in (lambda: self.cloud.query(progress=fail), lambda: list(self.cloud.chunks(progress=fail)),
                     lambda: pcmlab.outliers(self.path("cloud.pct"), output=self.path("never.pct"), progress=fail)):
            with self.assertRaisesRegex(Mine, "here"):
                call()
        self.assertFalse(os.path.exists(self.path("never.pct")))

    def test_the_lock_is_released(self):
        """A thread of Python works on while another one searches."""
        counts, done = [0], threading.Event()

        def count():
            while not done.is_set():
                counts[0] += 1

        counter = threading.Thread(target=count)
        places = numpy.tile(self.xyz[::10], (20, 1))
        counter.start()
        before = counts[0]
        self.cloud.nearest(places, 20, threads=1)
        during = counts[0] - before
        done.set()
        counter.join()
        self.assertGreater(during, 1000)

    def test_threads_share_a_cloud(self):
        sums = []
        threads = [threading.Thread(target=lambda: sums.append(int(self.cloud.query(attributes=["id"])["id"].sum())))
                   for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(sums, [self.points * (self.points - 1) // 2] * 4)

    def test_errors_say_what_where_and_what_to_do(self):
        with self.assertRaises(pcmlab.Error) as caught:
            pcmlab.open(self.path("nix.pct"))
        self.assertEqual((caught.exception.code, caught.exception.path), ("not_found", self.path("nix.pct")))
        with self.assertRaises(pcmlab.Error) as caught:
            pcmlab.build([self.path("cloud.pct")], output=self.path("x.pct"))
        self.assertTrue(caught.exception.hint)

    def test_nothing_leaks(self):
        def peak():
            return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

        for _ in range(20):
            self.cloud.query()
        before = peak()
        for _ in range(200):
            self.cloud.query()
        self.assertLess(peak() - before, 20_000)  # kB; one of the answers has 2,200

    def test_warnings_are_python_warnings(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            pcmlab.info([self.path("cloud.pct")])


class Stubs(unittest.TestCase):
    def test_they_have_every_operation(self):
        stubs = pathlib.Path(pcmlab.__file__).with_name("operations.pyi")
        functions = {f.name: f for f in ast.parse(stubs.read_text()).body if isinstance(f, ast.FunctionDef)}
        self.assertEqual(sorted(functions), sorted(pcmlab.operations.__all__))
        for name, function in functions.items():
            names = [a.arg for a in function.args.args + function.args.kwonlyargs]
            self.assertEqual(names, list(inspect.signature(getattr(pcmlab, name)).parameters), name)


del CloudTest  # its tests are those of the classes above
if __name__ == "__main__":
    unittest.main()
