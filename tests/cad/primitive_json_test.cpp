#include "pcm/cad/primitive_files.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/system/error.h"
#include "tests/support.h"

#include <fstream>
#include <limits>

namespace pcm {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Primitive full_primitive(ShapeKind kind, double x)
{
    Primitive primitive;
    primitive.name = "R\u00f6hre \u2265 \"5\", \\ </>";
    primitive.colour = {1, 2, 255};
    primitive.hidden = true;
    primitive.cloud = "folder/with \\ and \".pct";
    primitive.fit.shape = {kind, {x, -x / 3, 1e-7 * x}, normalised({0.1, 0.2, 0.3}), x / 13, 0.5 / 3};
    primitive.fit.verdict = FitVerdict::doubtful;
    primitive.fit.issue = FitIssue::uneven;  // the last one
    primitive.fit.message = "the arc is thin";
    primitive.fit.errors = {x / 7, 1e-9 / 3, infinity, 0.1};
    primitive.fit.condition = infinity;
    primitive.fit.threshold = 0.1 / 3;
    primitive.fit.noise = 0.2 / 3;
    primitive.fit.rms = 0.4 / 3;
    primitive.fit.inliers = std::numeric_limits<std::uint64_t>::max();
    primitive.fit.iterations = 77;
    primitive.fit.seconds = 0.1;
    primitive.stations =
        StationFacts{StationSource::time_gaps, 4294967295u, 0.0014 / 3, 7, 1.0 / 3, 0.002 / 3};  // the last one
    primitive.points = 12345678901;
    primitive.label = 4294967295u;
    primitive.estimator = "msac";
    if (kind == ShapeKind::plane) {
        primitive.bounds.outline = {{x, 0.1, 0.2}, {x / 3, 1, 2}, {x, 5, -7}};
    } else if (kind != ShapeKind::sphere) {
        if (kind != ShapeKind::torus) {
            primitive.bounds.from = 1.0 / 3;
            primitive.bounds.to = 7.0 / 3;
        }
        primitive.bounds.zero = AxisFrame(primitive.fit.shape.axis).u;
        primitive.bounds.begin = 6;
        primitive.bounds.end = 6 + 1.0 / 3;
    }
    return primitive;
}

void expect_equal(const Primitive& a, const Primitive& b)
{
    ASSERT_EQ(a.stations.has_value(), b.stations.has_value());
    if (a.stations) {
        EXPECT_EQ(a.stations->source, b.stations->source);
        EXPECT_EQ(a.stations->stations, b.stations->stations);
        EXPECT_EQ(a.stations->spread, b.stations->spread);
        EXPECT_EQ(a.stations->freedom, b.stations->freedom);
        EXPECT_EQ(a.stations->registration, b.stations->registration);
        EXPECT_EQ(a.stations->ray_share, b.stations->ray_share);
    }
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.colour, b.colour);
    EXPECT_EQ(a.hidden, b.hidden);
    EXPECT_EQ(a.cloud, b.cloud);
    const ShapeTraits& traits = traits_of(a.fit.shape.kind);
    EXPECT_EQ(a.fit.shape.kind, b.fit.shape.kind);
    EXPECT_EQ(a.fit.shape.point, b.fit.shape.point);
    if (traits.has_axis()) EXPECT_EQ(a.fit.shape.axis, b.fit.shape.axis);
    if (traits.has_radius()) EXPECT_EQ(a.fit.shape.radius, b.fit.shape.radius);
    if (traits.has_size(&Shape::second)) EXPECT_EQ(a.fit.shape.second, b.fit.shape.second);
    EXPECT_EQ(a.fit.verdict, b.fit.verdict);
    EXPECT_EQ(a.fit.issue, b.fit.issue);
    EXPECT_EQ(a.fit.message, b.fit.message);
    EXPECT_EQ(a.fit.errors.position, b.fit.errors.position);
    EXPECT_EQ(a.fit.errors.angle, b.fit.errors.angle);
    EXPECT_EQ(a.fit.errors.radius, b.fit.errors.radius);
    EXPECT_EQ(a.fit.errors.second, b.fit.errors.second);
    EXPECT_EQ(a.fit.condition, b.fit.condition);
    EXPECT_EQ(a.fit.threshold, b.fit.threshold);
    EXPECT_EQ(a.fit.noise, b.fit.noise);
    EXPECT_EQ(a.fit.rms, b.fit.rms);
    EXPECT_EQ(a.fit.inliers, b.fit.inliers);
    EXPECT_EQ(a.fit.iterations, b.fit.iterations);
    EXPECT_EQ(a.fit.seconds, b.fit.seconds);
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.label, b.label);
    EXPECT_EQ(a.estimator, b.estimator);
    EXPECT_EQ(a.bounds.outline, b.bounds.outline);
    EXPECT_EQ(a.bounds.from, b.bounds.from);
    EXPECT_EQ(a.bounds.to, b.bounds.to);
    EXPECT_EQ(a.bounds.zero, b.bounds.zero);
    EXPECT_EQ(a.bounds.begin, b.bounds.begin);
    EXPECT_EQ(a.bounds.end, b.bounds.end);
}

TEST(PrimitiveJson, TextKeepsEveryBit)
{
    std::vector<Primitive> primitives;
    for (const ShapeTraits& traits : shape_kinds())
        for (const double x : {500000.123456789, 1.0 / 3, 1e140}) primitives.push_back(full_primitive(traits.kind, x));
    for (Primitive& primitive : primitives)
        if (primitive.fit.shape.kind == ShapeKind::torus) primitive.fit.shape.second = primitive.fit.shape.radius / 3;
    const std::string text = json_of(primitives);
    const std::vector<Primitive> read = parse_primitives(text);
    ASSERT_EQ(read.size(), primitives.size());
    for (std::size_t i = 0; i < read.size(); ++i) expect_equal(primitives[i], read[i]);
    EXPECT_EQ(json_of(read), text);
    EXPECT_TRUE(parse_primitives(json_of(std::vector<Primitive>{})).empty());
}

TEST(PrimitiveJson, ALengthMayBeginOrEndAtTheShapesPoint)
{
    for (const auto& [from, to] : {std::pair{0.0, 2.0}, {-2.0, 0.0}}) {
        Primitive pipe = full_primitive(ShapeKind::cylinder, 1);
        pipe.bounds.from = from;
        pipe.bounds.to = to;
        expect_equal(pipe, parse_primitives(json_of({pipe}))[0]);
    }
}

TEST(PrimitiveJson, WhatIsNotNeededMayBeLeftOut)
{
    const auto read = parse_primitives(R"({"format":"pcm primitives","version":1,"primitives":[
        {"name":"a","kind":"cylinder","point":[1,2,3],"axis":[0,0,2],"radius":0.5}]})");
    ASSERT_EQ(read.size(), 1u);
    EXPECT_EQ(read[0].fit.shape.axis, (Vec3d{0, 0, 1}));
    EXPECT_EQ(read[0].fit.verdict, FitVerdict::good);
    EXPECT_FALSE(read[0].bounds.known(ShapeKind::cylinder));
    for (const char* axis : {"[0,1.7e308,1.7e308]", "[0,5e-324,5e-324]"}) {
        const auto extreme = parse_primitives(R"({"format":"pcm primitives","version":1,"primitives":[
            {"name":"a","kind":"plane","point":[1,2,3],"axis":)" +
                                              std::string(axis) + "}]}");
        EXPECT_NEAR(extreme[0].fit.shape.axis[1], std::sqrt(0.5), 1e-15);
    }
}

TEST(PrimitiveJson, WhatCannotBeKeptIsRefused)
{
    Primitive primitive = full_primitive(ShapeKind::cylinder, 1);
    EXPECT_NO_THROW(json_of({primitive}));
    primitive.fit.rms = infinity;
    EXPECT_THROW(json_of({primitive}), Error);
    primitive = full_primitive(ShapeKind::cylinder, 1);
    primitive.fit.errors.angle = std::nan("");
    EXPECT_THROW(json_of({primitive}), Error);
    primitive = full_primitive(ShapeKind::cylinder, 1);
    primitive.fit.shape.radius = 0;
    EXPECT_THROW(json_of({primitive}), Error);
    primitive = full_primitive(ShapeKind::cylinder, 1);
    primitive.name.clear();
    EXPECT_THROW(json_of({primitive}), Error);
}

std::string error_of(const std::string& text)
{
    try {
        parse_primitives(text);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::bad_format);
        return error.what();
    }
    return "accepted";
}

TEST(PrimitiveJson, WrongTextIsNamed)
{
    const auto list = [](const std::string& fields) {
        return R"({"format":"pcm primitives","version":1,"primitives":[{)" + fields + "}]}";
    };
    const auto sphere = [&](const std::string& fields) {
        return list(R"("name":"a","kind":"sphere","point":[1,2,3],"radius":2)" + fields);
    };
    const auto pipe = [&](const std::string& bounds) {
        return list(R"("name":"a","kind":"cylinder","point":[1,2,3],"axis":[0,0,1],"radius":2,"bounds":{)" + bounds +
                    "}");
    };
    const auto plane = [&](const std::string& outline) {
        return list(R"("name":"a","kind":"plane","point":[1,2,3],"axis":[0,0,1],"bounds":{"outline":)" + outline + "}");
    };
    EXPECT_EQ(error_of(sphere("")), "accepted");
    EXPECT_EQ(error_of(pipe(R"("from":-1,"to":2,"zero":[1,0,0],"begin":6,"end":7)")), "accepted");
    const std::pair<std::string, std::string> cases[] = {
        {"", "not JSON"},
        {"[[[[", "not JSON"},
        {"[]", "not an object"},
        {"{}", "'format'"},
        {R"({"format":"pcm measures","version":1,"primitives":[]})", "'format'"},
        {R"({"format":"pcm primitives","version":2,"primitives":[]})", "'version'"},
        {R"({"format":"pcm primitives","version":1})", "'primitives' of the file"},
        {R"({"format":"pcm primitives","version":1,"primitives":[1]})", "primitive 1 is not an object"},
        {list(R"("kind":"sphere","point":[1,2,3],"radius":2)"), "'name' of primitive 1"},
        {list(R"("name":"","kind":"sphere","point":[1,2,3],"radius":2)"), "is empty"},
        {list(R"("name":"a","kind":"cube","point":[1,2,3])"), "'cube', which is not a kind"},
        {list(R"("name":"a","kind":"sphere","point":[1,2,3])"), "'radius' of primitive 1"},
        {list(R"("name":"a","kind":"sphere","point":[1,2,3],"radius":0)"), "radius is not above 0"},
        {list(R"("name":"a","kind":"sphere","point":[1,2],"radius":1)"), "'point' of primitive 1 is not three"},
        {list(R"("name":"a","kind":"plane","point":[1,2,3],"axis":[0,0,0])"), "length 0"},
        {list(R"("name":"a","kind":"cone","point":[1,2,3],"axis":[0,0,1])"), "'half_angle'"},
        {list(R"("name":"a","kind":"torus","point":[1,2,3],"axis":[0,0,1],"radius":1,"tube_radius":1)"), "tube"},
        {sphere(R"(,"colour":[1,2])"), "'colour'"},
        {sphere(R"(,"colour":[1,2,256])"), "'colour'"},
        {sphere(R"(,"colour":[1,2,-1])"), "'colour'"},
        {sphere(R"(,"hidden":1)"), "'hidden'"},
        {sphere(R"(,"inliers":-1)"), "'inliers'"},
        {sphere(R"(,"inliers":1.5)"), "'inliers'"},
        {sphere(R"(,"label":4294967296)"), "'label'"},
        {sphere(R"(,"rms":-1)"), "'rms'"},
        {sphere(R"(,"rms":null)"), "'rms'"},
        {sphere(R"(,"verdict":"nice")"), "'verdict'"},
        {sphere(R"(,"issue":"odd")"), "'issue'"},
        {sphere(R"(,"sigma":3)"), "'sigma' of primitive 1 is not an object"},
        {sphere(R"(,"sigma":{"radius":"x"})"), "'radius' of 'sigma' of primitive 1"},
        {plane("[[1,2,3],[4,5,6]]"), "'outline' of 'bounds' of primitive 1 has fewer"},
        {plane("[[1,2,3],[4,5,6],[1,2]]"), "corner 3 of 'outline'"},
        {pipe(R"("from":3,"to":2)"), "'from'"},
        {pipe(R"("zero":[1,0,0.1],"begin":0,"end":1)"), "'zero'"},
        {pipe(R"("zero":[1,0,0],"begin":7,"end":8)"), "'begin'"},
        {pipe(R"("zero":[1,0,0],"begin":1,"end":1)"), "'end'"},
        {pipe(R"("zero":[1,0,0],"begin":1,"end":8)"), "'end'"},
        {list(R"("name":"a","kind":"cone","point":[0,0,0],"axis":[0,0,1],"half_angle":1,"bounds":{"from":-1,"to":1})"),
         "apex"},
    };
    for (const auto& [text, expected] : cases)
        EXPECT_NE(error_of(text).find(expected), std::string::npos) << text << "\n" << error_of(text);
}

TEST(PrimitiveJson, FilesAreNamedInErrors)
{
    const test::TemporaryFolder folder;
    EXPECT_THROW(read_primitives(folder / "none.json"), Error);
    std::ofstream(folder / "a.json") << "{}";
    try {
        read_primitives(folder / "a.json");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.path(), folder / "a.json");
    }
}

}  // namespace
}  // namespace pcm
