"""Replays a script of AutoCAD's commands as far as pcmlab writes them: keeps layers and the user's coordinate system, and
makes the solids. Numbers are exact (fractions). Whatever a real command line would not expect is an error."""
from fractions import Fraction


class ScriptError(Exception):
    pass


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def plus(a, b):
    return tuple(x + y for x, y in zip(a, b))


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def times(s, a):
    return tuple(s * x for x in a)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    """Exact but for the root, which is taken to 60 digits."""
    square = dot(a, a)
    digits = 10**60
    scaled = square.numerator * digits * digits // square.denominator
    root = Fraction(integer_root(scaled), digits)
    if root == 0:
        raise ScriptError("two points of a coordinate system are at one place")
    return times(1 / root, a)


def integer_root(n):
    import math
    return math.isqrt(n)


WORLD = ((Fraction(0),) * 3, (Fraction(1), Fraction(0), Fraction(0)), (Fraction(0), Fraction(1), Fraction(0)))


class Replay:
    def __init__(self, text):
        if not text.endswith("\r\n"):
            raise ScriptError("the last line does not end")
        self.lines = text[:-2].split("\r\n")
        self.place_in_file = 0
        self.origin, self.x, self.y = WORLD
        self.layers = {"0": None}
        self.layer = "0"
        self.open_groups = 0
        self.solids = []  # dictionaries, in the world's coordinates
        self.last = None

    def next(self):
        if self.place_in_file >= len(self.lines):
            raise ScriptError("the script ends inside a command")
        self.place_in_file += 1
        return self.lines[self.place_in_file - 1]

    def expect(self, text):
        if (found := self.next()) != text:
            raise ScriptError(f"line {self.place_in_file}: {found!r} instead of {text!r}")

    def number(self):
        text = self.next()
        if not text or text.strip("-.0123456789"):
            raise ScriptError(f"line {self.place_in_file}: {text!r} is not a plain number")
        return Fraction(text)

    def direction(self, d):
        return plus(plus(times(d[0], self.x), times(d[1], self.y)), times(d[2], cross(self.x, self.y)))

    def point(self):
        """In the world's coordinates. Without _NON an object snap could move it."""
        self.expect("_NON")
        return self.point_or("")

    def point_or(self, text):
        parts = text.split(",") if text else self.next().split(",")
        if len(parts) != 3 or any(not p or p.strip("-.0123456789") for p in parts):
            raise ScriptError(f"line {self.place_in_file}: {parts!r} is not a place")
        return plus(self.origin, self.direction(tuple(Fraction(p) for p in parts)))

    def run(self):
        while self.place_in_file < len(self.lines):
            line = self.next()
            if line.startswith(";"):
                continue
            name = line.replace("_.", "").replace("-", "").lower()
            command = getattr(self, "command_" + name, None)
            if not line.startswith("_.") or command is None:
                raise ScriptError(f"line {self.place_in_file}: {line!r} is no command")
            command()
        if self.open_groups or (self.origin, self.x, self.y) != WORLD:
            raise ScriptError("an undo group is open, or the coordinate system is not the world's")
        return self

    def add(self, **solid):
        self.last = dict(solid, layer=self.layer, z=cross(self.x, self.y))
        self.solids.append(self.last)

    def command_undo(self):
        self.open_groups += {"_BE": 1, "_E": -1}[self.next()]

    def command_3dpoly(self):
        corners = []
        while (line := self.next()) != "_C":
            if line != "_NON":
                raise ScriptError(f"line {self.place_in_file}: {line!r}")
            corners.append(self.point_or(""))
        self.add(kind="plane", corners=corners)

    def command_layer(self):
        while option := self.next():
            name = self.next()
            if option == "_M":
                if not name.replace("_", "").replace("-", "").replace("$", "").isascii() or " " in name:
                    raise ScriptError(f"a layer {name!r}")
                self.layers.setdefault(name, None)
                self.layer = name
            elif option == "_C":
                if name != "_T":
                    raise ScriptError(f"line {self.place_in_file}: a colour {name!r}")
                colour = tuple(int(c) for c in self.next().split(","))
                self.layers[self.next()] = colour
            elif option == "_S" and name in self.layers:
                self.layer = name
            else:
                raise ScriptError(f"line {self.place_in_file}: -LAYER {option!r} {name!r}")

    def command_ucs(self):
        option = self.next()
        if option == "_W":
            self.origin, self.x, self.y = WORLD
        elif option == "_3":
            origin, on_x, on_y = self.point(), self.point(), self.point()
            x = unit(minus(on_x, origin))
            towards_y = minus(on_y, origin)
            y = unit(minus(towards_y, times(dot(towards_y, x), x)))
            self.origin, self.x, self.y = origin, x, y
        else:
            raise ScriptError(f"line {self.place_in_file}: UCS {option!r}")

    def command_cylinder(self):
        self.add(kind="cylinder", base=self.point(), radius=self.number(), height=self.number())

    def command_sphere(self):
        self.add(kind="sphere", centre=self.point(), radius=self.number())

    def command_cone(self):
        base, radius, top, height = self.point(), self.number(), Fraction(0), self.next()
        if height == "_T":
            top, height = self.number(), self.next()
        self.add(kind="cone", base=base, radius=radius, top=top, height=Fraction(height))

    def command_torus(self):
        self.add(kind="torus", centre=self.point(), radius=self.number(), tube=self.number(), angle=360)

    def command_circle(self):
        self.add(kind="circle", centre=self.point(), radius=self.number())

    def command_revolve(self):
        """Of the circle made last, about an axis in its plane."""
        self.expect("_L")
        self.expect("")
        circle = self.solids.pop()
        begin, end, angle = self.point(), self.point(), self.number()
        axis = unit(minus(end, begin))
        out = minus(circle["centre"], begin)
        if circle["kind"] != "circle" or abs(dot(axis, circle["z"])) > Fraction(1, 10**14) or abs(dot(out, axis)) > Fraction(1, 10**14):
            raise ScriptError("what is revolved is not a circle in a plane with the axis")
        self.solids.append(dict(circle, kind="torus", centre=begin, axis=axis, begin=out, tube=circle["radius"],
                                angle=angle))

    def command_zoom(self):
        self.expect("_E")
