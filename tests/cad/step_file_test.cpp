// STEP files, as OpenCASCADE reads them: tests/step_facts.
#include "pcm/cad/drawing_list.h"
#include "pcm/cad/primitive_files.h"
#include "pcm/shapes/axis_frame.h"
#include "pcm/system/error.h"
#include "tests/support.h"

#include <nlohmann/json.hpp>

#include <fstream>
#include <random>
#include <sstream>

namespace pcm {
namespace {

using Json = nlohmann::json;

constexpr double nanometre = 1e-9;

class StepFile : public testing::Test {
protected:
    void SetUp() override
    {
        try {
            require_step("a.step");
        } catch (const Error& error) {
            ASSERT_EQ(error.code(), ErrorCode::unsupported);
            GTEST_SKIP() << error.what();
        }
    }

    test::TemporaryFolder folder_;

    // A line for each shape that OpenCASCADE reads.
    std::vector<Json> read_back(const std::filesystem::path& file, double millimetres = 1000)
    {
        const std::filesystem::path out = folder_ / "facts.txt";
        const std::string command = std::string(PCM_STEP_FACTS) + " '" + file.string() + "' " +
                                    std::to_string(millimetres) + " > '" + out.string() + "'";
        EXPECT_EQ(std::system(command.c_str()), 0) << command;
        std::vector<Json> facts;
        std::ifstream lines(out);
        for (std::string line; std::getline(lines, line);) facts.push_back(Json::parse(line));
        return facts;
    }
};

Vec3d vector_of(const Json& numbers) { return {numbers[0], numbers[1], numbers[2]}; }

// Distance of a point from a line through another.
double from_line(const Vec3d& p, const Vec3d& on, const Vec3d& axis)
{
    return length(p - on - dot(p - on, axis) * axis);
}

// A shape of each kind in turn, somewhere on a map, and what it measures: square metres, cubic metres.
Primitive random_shape(std::size_t i, std::mt19937& random, double& measure)
{
    std::uniform_real_distribution<double> unit(-1, 1), size(0.02, 3), metres(0, 900);
    Primitive p;
    p.fit.verdict = FitVerdict::good;
    Shape& shape = p.fit.shape;
    shape.kind = static_cast<ShapeKind>(i % 5);
    shape.point = {500000 + metres(random), 4800000 + metres(random), metres(random) / 10};
    shape.axis = normalised(Vec3d{unit(random), unit(random), unit(random)});
    const AxisFrame frame(shape.axis);
    p.bounds.from = size(random);
    p.bounds.to = p.bounds.from + 4 * size(random);
    const double tall = p.bounds.to - p.bounds.from;
    switch (shape.kind) {
        case ShapeKind::plane: {
            const double a = 5 * size(random), b = 5 * size(random);
            // An L, with one corner of the rectangle left out.
            for (const auto& [u, v] :
                 std::vector<std::pair<double, double>>{{0, 0}, {a, 0}, {a, b / 2}, {a / 2, b / 2}, {a / 2, b}, {0, b}})
                p.bounds.outline.push_back(shape.point + u * frame.u + v * frame.v);
            measure = 0.75 * a * b;
            break;
        }
        case ShapeKind::cylinder:
            shape.radius = size(random);
            measure = pi * shape.radius * shape.radius * tall;
            break;
        case ShapeKind::sphere:
            shape.radius = size(random);
            measure = 4 * pi / 3 * std::pow(shape.radius, 3);
            break;
        case ShapeKind::cone: {
            shape.second = 0.1 + 0.2 * size(random);
            if (i % 2) p.bounds.from = 0;  // to the apex
            const double slope = std::tan(shape.second);
            measure = pi / 3 * slope * slope * (std::pow(p.bounds.to, 3) - std::pow(p.bounds.from, 3));
            break;
        }
        case ShapeKind::torus:
            shape.radius = 0.5 + size(random);
            shape.second = 0.4 * shape.radius;
            measure = 2 * pi * shape.radius * pi * shape.second * shape.second;
            if (i % 2) {
                p.bounds.zero = frame.v;
                p.bounds.begin = 1 + unit(random);
                p.bounds.end = p.bounds.begin + 1.5 + unit(random);
                measure *= (p.bounds.end - p.bounds.begin) / (2 * pi);
            }
            break;
    }
    return p;
}

// Where the shape lies, as it was and as it was read.
void expect_same_surface(const Shape& shape, const Json& surface)
{
    EXPECT_EQ(surface["kind"], traits_of(shape.kind).name);
    const Vec3d place = vector_of(surface["place"]), axis = vector_of(surface["axis"]);
    const double rounding = 2e-9;  // two units in the last place of a northing
    switch (shape.kind) {
        case ShapeKind::plane:
            EXPECT_LE(std::fabs(dot(place - shape.point, shape.axis)), rounding);
            break;
        case ShapeKind::cylinder:
            EXPECT_LE(from_line(place, shape.point, shape.axis), rounding);
            break;
        default:
            EXPECT_LE(length(place - shape.point), rounding);
    }
    if (traits_of(shape.kind).has_axis()) EXPECT_LE(length(cross(axis, shape.axis)), 1e-14);
    if (traits_of(shape.kind).has_radius()) EXPECT_NEAR(double(surface["radius"]), shape.radius, nanometre);
    EXPECT_NEAR(double(surface["second"]), shape.second, nanometre);
}

// OpenCASCADE 7.6 reads a name with an apostrophe before a comma or a bracket as an empty one; ISO 10303-21 has them.
const std::string hostile[] = {
    "Pipe 'A'", "a\\b",       "\\X2\\0041\\X0\\", "Rohr Ø 200 – Süd", "罐 3", "#1=CARTESIAN_POINT(''0 (0.,0.,0.));",
    "ENDSEC;",  "two\nlines", "*/ /* \"",         "🛢 tank"};

TEST_F(StepFile, ShapesOfAllKindsOnTheMapAreReadBack)
{
    std::mt19937 random(7);
    std::vector<Primitive> all;
    std::vector<double> measures(120);
    for (std::size_t i = 0; i < measures.size(); ++i) {
        all.push_back(random_shape(i, random, measures[i]));
        all.back().name = hostile[i % std::size(hostile)] + " " + std::to_string(i);
        all.back().colour = {static_cast<std::uint8_t>(2 * i), static_cast<std::uint8_t>(255 - i),
                             static_cast<std::uint8_t>(i % 7 * 36)};
    }
    CadOptions options;
    options.unit = CadUnit::metres;
    const CadReport report = write_primitives(folder_ / "plant.step", all, options);
    EXPECT_EQ(report.written, 120u);
    EXPECT_TRUE(report.notes.empty());
    const std::vector<Json> facts = read_back(folder_ / "plant.step");
    ASSERT_EQ(facts.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        SCOPED_TRACE(all[i].name);
        EXPECT_EQ(facts[i]["name"], all[i].name);
        EXPECT_EQ(facts[i]["form"], all[i].fit.shape.kind == ShapeKind::plane ? "face" : "solid");
        EXPECT_TRUE(facts[i]["valid"]);
        EXPECT_EQ(facts[i]["colour"], Json(all[i].colour));
        EXPECT_NEAR(double(facts[i]["measure"]), measures[i], 1e-8 * measures[i]);
        expect_same_surface(all[i].fit.shape, facts[i]["surface"]);
    }
}

TEST_F(StepFile, LengthsKeepTheirNumbersInEveryUnit)
{
    Primitive pipe;
    pipe.name = "Pipe";
    pipe.fit.verdict = FitVerdict::good;
    pipe.fit.shape = parse_shape("cylinder 10 20 30 0 0 1 2.5");
    pipe.bounds.from = 1;
    pipe.bounds.to = 5;
    const std::pair<CadUnit, double> units[] = {{CadUnit::metres, 1000},
                                                {CadUnit::millimetres, 1},
                                                {CadUnit::centimetres, 10},
                                                {CadUnit::feet, 304.8},
                                                {CadUnit::inches, 25.4}};
    for (const auto& [unit, millimetres] : units) {
        CadOptions options;
        options.unit = unit;
        options.overwrite = true;
        write_primitives(folder_ / "a.stp", {pipe}, options);
        const std::vector<Json> same = read_back(folder_ / "a.stp", millimetres), metres = read_back(folder_ / "a.stp");
        ASSERT_EQ(same.size(), 1u) << millimetres;
        EXPECT_NEAR(double(same[0]["surface"]["radius"]), 2.5, 1e-12) << millimetres;
        EXPECT_NEAR(double(same[0]["measure"]), pi * 2.5 * 2.5 * 4, 1e-9) << millimetres;
        EXPECT_LE(length(vector_of(same[0]["surface"]["place"]) - Vec3d{10, 20, 31}), 1e-12) << millimetres;
        EXPECT_NEAR(double(metres[0]["surface"]["radius"]), 2.5 * millimetres / 1000, 1e-12);
    }
    const CadReport report = write_primitives(folder_ / "none.stp", {pipe});
    ASSERT_EQ(report.notes.size(), 1u);
    EXPECT_NE(report.notes[0].find("metres"), std::string::npos) << report.notes[0];
    EXPECT_NEAR(double(read_back(folder_ / "none.stp")[0]["surface"]["radius"]), 2.5, 1e-12);
}

TEST_F(StepFile, AShapeThatIsNoSolidIsNamedAndNothingIsLeft)
{
    Primitive bow;
    bow.name = "Bow tie";
    bow.fit.verdict = FitVerdict::good;
    bow.fit.shape = parse_shape("plane 0 0 0 0 0 1");
    bow.bounds.outline = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
    try {
        write_primitives(folder_ / "a.step", {bow});
        FAIL() << "a face whose edges cross was written";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        EXPECT_NE(std::string(error.what()).find("'Bow tie' cannot be written: its outline crosses itself"),
                  std::string::npos)
            << error.what();
    }
    std::ofstream(folder_ / "there.step") << "mine";
    EXPECT_THROW(write_primitives(folder_ / "there.step", {bow}), Error);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_ / "."), {}), 1);
}

}  // namespace
}  // namespace pcm
