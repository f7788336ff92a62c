#include "pcm/io/survey.h"

#include "pcm/cloud/nearest_float.h"
#include "tests/io/random_cloud.h"

namespace pcm::test {
namespace {

// One attribute of one point a batch.
class Watching {
public:
    Watching(ScalarType type, Question question)
    {
        info_.schema.add({"a", type, 1, 1, 0, {}});
        SurveyQuestions questions;
        questions.attributes = {question};
        surveyor_.emplace(info_, questions);
    }
    template <class T>
    Watching& see(T value)
    {
        PointBatch batch;
        batch.reset(info_.schema, false, 1);
        *batch.attributes[0].as<T>() = value;
        surveyor_->watch(batch);
        return *this;
    }
    bool open() const { return surveyor_->open(); }
    ValueSurvey answer() const { return *surveyor_->answers().of(0); }

private:
    FileInfo info_;
    std::optional<Surveyor> surveyor_;
};

TEST(Survey, StepsOfColours)
{
    const auto steps = [](const std::vector<std::uint16_t>& values) {
        Watching watching(ScalarType::u16, Question::colour_steps);
        EXPECT_TRUE(watching.open());
        for (const std::uint16_t v : values) watching.see(v);
        EXPECT_EQ(watching.open(), watching.answer().colour_step != 0);
        return watching.answer().colour_step;
    };
    EXPECT_EQ(steps({}), 257u);
    EXPECT_EQ(steps({0, 257, 65535}), 257u);
    EXPECT_EQ(steps({0, 256, 65280}), 256u);
    EXPECT_EQ(steps({0, 1, 255}), 1u);
    EXPECT_EQ(steps({0, 257, 256}), 0u);
    EXPECT_EQ(steps({1, 256}), 0u);
    EXPECT_EQ(steps({65534}), 0u);
}

TEST(Survey, RangesAndWholeNumbers)
{
    Watching floats(ScalarType::f32, Question::range);
    EXPECT_FALSE(floats.answer().any());
    EXPECT_TRUE(floats.answer().within(0, 0));
    floats.see(-3.f).see(7.f);
    EXPECT_TRUE(floats.answer().whole);
    floats.see(std::nanf("")).see(std::numeric_limits<float>::infinity());
    EXPECT_FALSE(floats.answer().whole);
    EXPECT_EQ(floats.answer().least, -3);
    EXPECT_EQ(floats.answer().most, 7);
    EXPECT_TRUE(floats.answer().within(-3, 7));
    EXPECT_FALSE(floats.answer().within(-2, 7));
    EXPECT_FALSE(floats.answer().within(-3, 6));
    EXPECT_TRUE(floats.open());
    EXPECT_FALSE(Watching(ScalarType::f32, Question::range).see(0.5f).answer().whole);
}

TEST(Survey, DoublesAndWideIntegers)
{
    constexpr std::int64_t limit = std::int64_t{1} << 53;
    for (const std::int64_t v : {limit - 1, 1 - limit, std::int64_t{0}})
        EXPECT_TRUE(Watching(ScalarType::i64, Question::doubles).see(v).answer().doubles_hold) << v;
    for (const std::int64_t v : {limit + 1, -limit - 1, std::numeric_limits<std::int64_t>::min()}) {
        const Watching watching = Watching(ScalarType::i64, Question::doubles).see(v);
        EXPECT_FALSE(watching.answer().doubles_hold) << v;
        EXPECT_FALSE(watching.open());
    }
    EXPECT_FALSE(Watching(ScalarType::u64, Question::doubles).see(~std::uint64_t{0}).answer().doubles_hold);
}

TEST(Survey, FloatsHoldSmallGridsAndFloatsAlone)
{
    const auto holds = [](const std::optional<Grid>& grid, const std::vector<double>& x) {
        FileInfo info;
        info.grid = grid;
        SurveyQuestions questions;
        questions.floats = true;
        Surveyor surveyor(info, questions);
        PointBatch batch;
        batch.reset({}, grid.has_value(), x.size());
        for (std::size_t i = 0; i < x.size(); ++i)
            for (std::size_t a = 0; a < 3; ++a)
                if (grid)
                    batch.grid_xyz[a][i] = static_cast<std::int32_t>(x[i]);
                else
                    batch.xyz[a][i] = x[i];
        surveyor.watch(batch);
        EXPECT_EQ(surveyor.open(), surveyor.answers().floats_hold_positions);
        return surveyor.answers().floats_hold_positions;
    };
    EXPECT_TRUE(holds({}, {0.5, -1e30, std::nan("")}) == (nearest_float(1e30) == 1e30));
    EXPECT_TRUE(holds({}, {0.5, 16777216}));
    EXPECT_FALSE(holds({}, {0.1}));
    const Grid millimetres{{0.001, 0.001, 0.001}, {0, 0, 0}};
    EXPECT_TRUE(holds(millimetres, {0, 1, -4000000}));
    EXPECT_FALSE(holds(millimetres, {0, 1, -400000001}));
    EXPECT_FALSE(holds(Grid{{0.001, 0.001, 0.001}, {500000, 0, 0}}, {123}));
}

// Every point of a grid whose coordinate a float names is found again; others keep the float.
TEST(Survey, CoordinatesOfFloats)
{
    const Grid grid{{0.001, 0.01, 0.0625}, {500000, -4800000.5, 3}};
    std::mt19937_64 random(1);
    for (int i = 0; i < 20000; ++i)
        for (std::size_t a = 0; a < 3; ++a) {
            const auto q = static_cast<std::int32_t>(random() % 2000001) - 1000000;
            const double v = grid.to_source(q, a), shift = std::round(grid.offset[a]);
            ASSERT_TRUE(float_names_grid_point(grid, a, q, shift));
            const auto stored = static_cast<float>(v - shift);
            ASSERT_EQ(coordinate_of_float(grid, a, stored, shift), v);
            ASSERT_EQ(coordinate_of_float({}, a, stored, shift), static_cast<double>(stored) + shift);
        }
    EXPECT_EQ(coordinate_of_float(grid, 2, 0.03f, 0), static_cast<double>(0.03f)) << "between two points";
    EXPECT_TRUE(std::isnan(coordinate_of_float(grid, 0, std::nanf(""), 0)));
}

}  // namespace
}  // namespace pcm::test
