// Lists of measures: names, undo, text.
#include "pcm/measure/measure_list.h"

#include "pcm/system/error.h"
#include "tests/support.h"

#include <fstream>
#include <limits>
#include <random>

namespace {

using namespace pcm;

Measure distance(const Vec3d& a, const Vec3d& b)
{
    Measure measure;
    measure.points = {{a, 0.1, 0.001, "a.pct"}, {b, 0, 0, ""}};
    return measure;
}

Measure full_measure(double x)
{
    Measure measure;
    measure.kind = MeasureKind::surface;
    measure.name = "Wall \"north\", ä\u4e2d";
    measure.points = {{{x, -x / 3, 1e-7 * x}, x / 7, x * 1e-9, "folder/with \\ and \".pct"}};
    measure.hidden = true;
    measure.width = x / 11;
    measure.surface = Shape{ShapeKind::cylinder, {x, x / 3, -x}, normalised({0.1, 0.2, 0.3}), x / 13, 0};
    measure.computed = {{"net", -x / 17, x / 19, "^3"}, {"area", x, 0, "^2"}};
    return measure;
}

void expect_equal(const Measure& a, const Measure& b)
{
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.hidden, b.hidden);
    EXPECT_EQ(a.width, b.width);
    ASSERT_EQ(a.surface.has_value(), b.surface.has_value());
    if (a.surface) {
        EXPECT_EQ(a.surface->kind, b.surface->kind);
        EXPECT_EQ(a.surface->point, b.surface->point);
        EXPECT_EQ(a.surface->axis, b.surface->axis);
        EXPECT_EQ(a.surface->radius, b.surface->radius);
    }
    ASSERT_EQ(a.points.size(), b.points.size());
    for (std::size_t i = 0; i < a.points.size(); ++i) {
        EXPECT_EQ(a.points[i].position, b.points[i].position);
        EXPECT_EQ(a.points[i].spacing, b.points[i].spacing);
        EXPECT_EQ(a.points[i].grid_step, b.points[i].grid_step);
        EXPECT_EQ(a.points[i].cloud, b.points[i].cloud);
    }
    ASSERT_EQ(a.computed.size(), b.computed.size());
    for (std::size_t i = 0; i < a.computed.size(); ++i) {
        EXPECT_EQ(a.computed[i].name, b.computed[i].name);
        EXPECT_EQ(a.computed[i].value, b.computed[i].value);
        EXPECT_EQ(a.computed[i].uncertainty, b.computed[i].uncertainty);
        EXPECT_EQ(a.computed[i].unit, b.computed[i].unit);
    }
}

std::vector<std::string> names(const MeasureList& list)
{
    std::vector<std::string> found;
    for (std::size_t i = 0; i < list.size(); ++i) found.push_back(list[i].name);
    return found;
}

using Names = std::vector<std::string>;

TEST(MeasureList, NamesAreFreeNumbersOfTheKind)
{
    MeasureList list;
    list.add(distance({0, 0, 0}, {1, 0, 0}));
    list.add(distance({0, 0, 0}, {2, 0, 0}));
    Measure angle;
    angle.kind = MeasureKind::angle;
    list.add(angle);
    list.remove(0);
    list.add(distance({0, 0, 0}, {3, 0, 0}));
    EXPECT_EQ(names(list), (Names{"Distance 2", "Angle 1", "Distance 1"}));
    for (const std::string& bad : {std::string(), std::string("a\nb"), std::string(1001, 'x')})
        EXPECT_THROW(list.rename(0, bad), Error);
    EXPECT_EQ(list[0].name, "Distance 2");
    EXPECT_THROW(list.rename(3, "x"), Error);
    EXPECT_THROW(list.remove(3), Error);
    EXPECT_THROW(list.hide(3, true), Error);
    EXPECT_THROW(list.replace(3, angle), Error);
    EXPECT_THROW(list.at(3), Error);
}

// Every change can be undone and redone: random changes against a list of all states.
TEST(MeasureList, UndoAndRedoOfEveryChange)
{
    std::mt19937_64 random(1);
    MeasureList list;
    std::vector<std::string> states{list.text()};
    std::size_t now = 0;
    for (int step = 0; step < 600; ++step) {
        const std::size_t at = list.empty() ? 0 : random() % list.size();
        const auto changed = [&] {
            states.resize(now + 1);
            states.push_back(list.text());
            ++now;
        };
        switch (random() % 7) {
            case 0:
            case 1:
                list.add(distance({0, 0, 0}, {1.0 + step, 0, 0}));
                changed();
                break;
            case 2:
                if (list.empty()) break;
                list.rename(at, "name " + std::to_string(step));
                changed();
                break;
            case 3:
                if (list.empty()) break;
                list.hide(at, !list[at].hidden);
                changed();
                break;
            case 4:
                if (list.empty()) break;
                if (step % 50 == 0)
                    list.clear();
                else
                    list.remove(at);
                changed();
                break;
            case 5:
                list.undo();
                if (now > 0) --now;
                break;
            case 6:
                list.redo();
                if (now + 1 < states.size()) ++now;
                break;
        }
        ASSERT_EQ(list.text(), states[now]) << step;
        ASSERT_EQ(list.can_undo(), now > 0);
        ASSERT_EQ(list.can_redo(), now + 1 < states.size());
    }
}

TEST(MeasureList, TextKeepsEveryBit)
{
    MeasureList list;
    for (const double x : {1.0 / 3, 4800000.123456789, 1e-290, 1e140, 123456789.0123}) list.add(full_measure(x));
    Measure plain = distance({500000.1, 4800000.2, 0.3}, {1, 2, 3});
    list.add(plain);
    const MeasureList back = MeasureList::parse(list.text());
    ASSERT_EQ(back.size(), list.size());
    for (std::size_t i = 0; i < list.size(); ++i) expect_equal(back[i], list[i]);
    EXPECT_FALSE(back.can_undo());
    EXPECT_EQ(back.text(), list.text());
}

TEST(MeasureList, NumbersThatAreNotFiniteAreNotKept)
{
    MeasureList list;
    Measure measure = distance({0, 0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0, 0});
    list.add(measure);
    EXPECT_THROW(list.text(), Error);
}

TEST(MeasureList, WrongTextIsNamed)
{
    const auto error = [](const std::string& text) -> std::string {
        try {
            MeasureList::parse(text);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::bad_format) << text;
            return error.what();
        }
        return "accepted";
    };
    const auto measure = [](const std::string& fields) {
        return R"({"format":"pcm measures","version":1,"measures":[{)" + fields + "}]}";
    };
    const std::string points = R"("points":[{"position":[1,2,3]}])";
    EXPECT_EQ(error(measure(R"("kind":"point","name":"a",)" + points)), "accepted");
    const std::pair<std::string, std::string> cases[] = {
        {"", "not JSON"},
        {"{", "not JSON"},
        {"[]", "not an object"},
        {"{}", "'format'"},
        {R"({"format":"other","version":1,"measures":[]})", "'format'"},
        {R"({"format":"pcm measures","version":2,"measures":[]})", "'version'"},
        {R"({"format":"pcm measures","version":1})", "'measures'"},
        {R"({"format":"pcm measures","version":1,"measures":[3]})", "measure 1"},
        {measure(R"("name":"a",)" + points), "'kind' of measure 1"},
        {measure(R"("kind":"length","name":"a",)" + points), "'length'"},
        {measure(R"("kind":"point",)" + points), "'name' of measure 1"},
        {measure(R"("kind":"point","name":"a\nb",)" + points), "control characters"},
        {measure(R"("kind":"point","name":"a","hidden":1,)" + points), "'hidden' of measure 1"},
        {measure(R"("kind":"point","name":"a","width":-1,)" + points), "'width' of measure 1"},
        {measure(R"("kind":"point","name":"a","surface":"cone 1",)" + points), "'surface' of measure 1"},
        {measure(R"("kind":"point","name":"a")"), "'points' of measure 1"},
        {measure(R"("kind":"point","name":"a","points":[{"position":[1,2]}])"), "'position' of point 1 of measure 1"},
        {measure(R"("kind":"point","name":"a","points":[{"position":[1,2,"3"]}])"), "'position' of point 1"},
        {measure(R"("kind":"point","name":"a","points":[{"position":[1,2,1e999]}])"), "JSON"},
        {measure(R"("kind":"point","name":"a","points":[{"position":[1,2,3],"spacing":"x"}])"), "'spacing' of point 1"},
        {measure(R"("kind":"point","name":"a","points":[{"position":[1,2,3],"grid_step":-1}])"), "'grid_step'"},
        {measure(R"("kind":"point","name":"a","points":[{"position":[1,2,3],"cloud":5}])"), "'cloud'"},
        {measure(R"("kind":"volume","name":"a","computed":[{"name":"net","value":1,"unit":""}],)" + points),
         "'uncertainty' of a computed value of measure 1"},
    };
    for (const auto& [text, expected] : cases)
        EXPECT_NE(error(text).find(expected), std::string::npos) << text << "\n" << error(text);
}

TEST(MeasureList, SurfacesWithAnAxisOfAnyLengthAreRead)
{
    const auto distance = [](const std::string& surface) {
        const MeasureList list =
            MeasureList::parse(R"({"format":"pcm measures","version":1,"measures":[{"kind":"surface","name":"a",)"
                               R"("surface":")" +
                               surface + R"(","points":[{"position":[3,4,9]}]}]})");
        return values_of(list[0])[0].value;
    };
    EXPECT_DOUBLE_EQ(distance("cylinder 0 0 0 0 0 0.25 2"), 3);
    EXPECT_DOUBLE_EQ(distance("plane 0 0 1 0 0 -7"), 8);
    EXPECT_DOUBLE_EQ(distance("cone 0 0 9 0 0 7 45"), std::sqrt(12.5));
}

TEST(MeasureList, FilesAreNamedInErrors)
{
    const test::TemporaryFolder folder;
    EXPECT_THROW(MeasureList::read(folder / "none.json"), Error);
    std::ofstream(folder / "bad.json") << "{\"format\":\"pcm measures\"}";
    try {
        MeasureList::read(folder / "bad.json");
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("bad.json"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("'version'"), std::string::npos) << error.what();
    }
}

}  // namespace
