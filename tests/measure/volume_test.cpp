// Volumes against surfaces whose volume is known.
#include "pcm/measure/volume.h"

#include "pcm/measure/gap_filling.h"
#include "pcm/measure/height_cells.h"
#include "pcm/system/error.h"
#include "tests/measure/measured_tree.h"
#include "tests/outcome.h"

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace {

using namespace pcm;
using namespace pcm::test;

const Vec3d origin{500000, 4800000, 100};

// Points of the surface z = height(x, y) over 20 x 20, with noise; relative to the origin.
std::vector<Vec3d> surface(const std::function<double(double, double)>& height, std::size_t count, double noise,
                           std::uint64_t seed, const std::function<bool(double, double)>& has = {})
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0, 20);
    std::normal_distribution<double> normal(0, 1);
    std::vector<Vec3d> points;
    while (points.size() < count) {
        const double x = unit(random), y = unit(random);
        if (has && !has(x, y)) continue;
        points.push_back(origin + Vec3d{x, y, height(x, y) + noise * normal(random)});
    }
    return points;
}

std::vector<Vec3d> at_origin(std::vector<Vec3d> polygon)
{
    for (Vec3d& p : polygon) p = p + origin;
    return polygon;
}

const std::vector<Vec3d> square{{2, 2, 0}, {18, 2, 0}, {18, 18, 0}, {2, 18, 0}};

TEST(HeightCells, MergedCellsAreAsIfFilledTogether)
{
    std::mt19937_64 random(4);
    std::normal_distribution<double> normal(1e6, 0.01);
    HeightCell all, parts[3], merged;
    std::vector<double> heights;
    for (int i = 0; i < 1000; ++i) {
        heights.push_back(normal(random));
        all.add(heights.back());
        parts[random() % 2].add(heights.back());
    }
    for (const HeightCell& part : parts) merged.add(part);
    long double mean = 0, squares = 0;
    for (const double h : heights) mean += h / 1000.0L;
    for (const double h : heights) squares += (h - mean) * (h - mean);
    for (const HeightCell& cell : {all, merged}) {
        EXPECT_EQ(cell.points, 1000u);
        EXPECT_NEAR(cell.mean, double(mean), 1e-9);
        EXPECT_NEAR(cell.squares, double(squares), 1e-6 * double(squares));
        EXPECT_EQ(cell.lowest, *std::min_element(heights.begin(), heights.end()));
        EXPECT_EQ(cell.highest, *std::max_element(heights.begin(), heights.end()));
    }
}

TEST(GapFilling, GapsOfAPlaneAreFilledWithThePlane)
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr std::size_t columns = 30, rows = 20;
    std::vector<double> height(columns * rows), areas(columns * rows, 1);
    const auto plane = [](std::size_t cell) {
        return 0.3 * static_cast<double>(cell % columns) - 0.2 * static_cast<double>(cell / columns);
    };
    for (std::size_t cell = 0; cell < height.size(); ++cell) {
        const std::size_t x = cell % columns, y = cell / columns;
        height[cell] = x > 4 && x < 15 && y > 3 && y < 16 ? nan : plane(cell);
    }
    areas[columns + 20] = 0;  // a cell outside of the polygon is never filled
    height[columns + 20] = nan;
    const FilledCells filled = fill_gaps(height, areas, columns);
    for (std::size_t cell = 0; cell < height.size(); ++cell) {
        if (cell == columns + 20) {
            EXPECT_TRUE(std::isnan(filled.height[cell]));
            continue;
        }
        EXPECT_NEAR(filled.height[cell], plane(cell), 1e-6);
        EXPECT_EQ(filled.width[cell], std::isnan(height[cell]) ? 10u : 0u);
        EXPECT_FALSE(filled.outer[cell]);
        EXPECT_LT(filled.sigma[cell], 1e-3);  // a plane is interpolated exactly
    }
    EXPECT_TRUE(std::isnan(fill_gaps(std::vector<double>(4, nan), {1, 1, 1, 1}, 2).height[0]));
    EXPECT_FALSE(fill_gaps({1, 2, 3, 4}, {1, 1, 1, 1}, 2).filled);
}

TEST(GapFilling, GapsSolveLaplacesEquation)
{
    // The real part of a power of x + i y is harmonic; cells next to each other differ little from its mean value.
    constexpr std::size_t columns = 120, rows = 120;
    std::vector<double> height(columns * rows), areas(columns * rows, 1);
    const auto harmonic = [](std::size_t cell) {
        const double x = static_cast<double>(cell % columns) / 60 - 1, y = static_cast<double>(cell / columns) / 60 - 1;
        return x * x * x - 3 * x * y * y;
    };
    for (std::size_t cell = 0; cell < height.size(); ++cell) {
        const std::size_t x = cell % columns, y = cell / columns;
        height[cell] =
            x > 20 && x < 100 && y > 10 && y < 90 ? std::numeric_limits<double>::quiet_NaN() : harmonic(cell);
    }
    const FilledCells filled = fill_gaps(height, areas, columns);
    for (std::size_t cell = 0; cell < height.size(); ++cell) EXPECT_NEAR(filled.height[cell], harmonic(cell), 0.01);
}

TEST(GapFilling, CellsBesideTheKnownOnesAreExtrapolatedAndLessCertain)
{
    constexpr std::size_t columns = 60, rows = 40;
    std::vector<double> height(columns * rows), areas(columns * rows, 1);
    std::mt19937_64 random(9);
    std::normal_distribution<double> normal(0, 0.1);
    for (std::size_t cell = 0; cell < height.size(); ++cell) {
        const std::size_t x = cell % columns, y = cell / columns;
        const bool gap = x >= 44 || (x >= 10 && x < 18 && y >= 10 && y < 18);
        height[cell] =
            gap ? std::numeric_limits<double>::quiet_NaN()
                : std::sin(static_cast<double>(x) / 9) + std::cos(static_cast<double>(y) / 7) + normal(random);
    }
    const FilledCells filled = fill_gaps(height, areas, columns);
    const std::size_t inner = 14 * columns + 14, near = 20 * columns + 44, far = 20 * columns + 59;
    EXPECT_FALSE(filled.outer[inner]);
    EXPECT_EQ(filled.width[inner], 8u);
    EXPECT_TRUE(filled.outer[near]);
    EXPECT_EQ(filled.width[near], 2u);
    EXPECT_EQ(filled.width[far], 32u);
    EXPECT_GT(filled.sigma[inner], 0);
    EXPECT_GT(filled.sigma[far], 2 * filled.sigma[inner]);
    EXPECT_GT(filled.sigma[far], 2 * filled.sigma[near]);
    // The errors of one gap add up, those of gaps far from each other add as squares.
    std::vector<double> one(height.size(), 0);
    double sum = 0;
    for (std::size_t y = 10; y < 18; ++y)
        for (std::size_t x = 10; x < 18; ++x) {
            one[y * columns + x] = 2;
            sum += 2 * filled.sigma[y * columns + x];
        }
    const double common = 64 * 2 * filled.step[inner];
    EXPECT_NEAR(gap_uncertainty(filled, one, columns), std::hypot(sum, common), 1e-9 * sum);
}

// Four known cells in a row: too few can be hidden to learn from. Their heights have no mean and no slope: they are
// the differences from the plane.
TEST(GapFilling, WhereTooFewCellsCanBeHiddenTheErrorIsTheSpreadOfTheKnownOnes)
{
    const double nan = std::numeric_limits<double>::quiet_NaN(), e = 0.01;
    const double variance = (1 + 4 + 4 + 1) * e * e / 3, jump = 4 * e;
    for (const double spread : {0.0, e, 5 * e}) {  // differences are kept as floats: to seven digits
        const FilledCells filled = fill_gaps({e, -2 * e, nan, 2 * e, -e}, {1, 1, 1, 1, 1}, 5, spread);
        ASSERT_FALSE(filled.outer[2]);
        ASSERT_EQ(filled.width[2], 1u);
        const double usual = std::max(variance, spread * spread);
        EXPECT_NEAR(std::pow(filled.sigma[2], 2), (usual + jump * jump) / 2, 1e-9) << spread;
        EXPECT_NEAR(filled.step[2], std::max(0.0, jump - std::sqrt(usual)) / 2, 1e-8) << spread;
    }
    // Two equal heights have no spread: that within a cell remains.
    EXPECT_NEAR(fill_gaps({1, nan, nan, 1}, {1, 1, 1, 1}, 4, 0.2).sigma[1], 0.2, 1e-9);
}

class Volumes : public testing::Test {
protected:
    TemporaryFolder folder_;
};

TEST_F(Volumes, OfASlopeAgainstAHeightAndAgainstItself)
{
    const auto slope = [](double x, double y) { return 0.1 * (x - 10) + 0.05 * (y - 10); };
    const auto cloud = measured_tree(folder_, "a", surface(slope, 120000, 0.01, 1), origin);
    VolumeOptions options;
    options.polygon = at_origin(square);
    options.reference.height = origin[2] - 3;
    options.side = 0.5;
    const Stopwatch watch;
    const VolumeReport above = measure_volume(*cloud, options);
    expect_outcome(above.outcome, above.outcome.points_in, above.points[0] + above.points[1], watch);
    EXPECT_GE(above.outcome.points_in, above.outcome.points_out);
    EXPECT_GT(above.outcome.points_out, 70000u);  // 120,000 points lie on 20 by 20; the area is 16 by 16
    EXPECT_EQ(above.outcome.error, above.values()[0].uncertainty);
    EXPECT_NEAR(above.area, 256, 1e-9);
    EXPECT_EQ(above.fill, 0);
    EXPECT_EQ(above.area_without_data, 0);
    EXPECT_NEAR(above.net(), 3 * 256, 5 * above.net_spread);
    EXPECT_GT(above.net_spread, 0);
    // Half of it lies above its middle: the integral of |slope| is that of the two sides.
    options.reference.height = origin[2];
    options.side = 0;
    const VolumeReport both = measure_volume(*cloud, options);
    double truth = 0;
    for (int i = 0; i < 1600; ++i)
        for (int j = 0; j < 1600; ++j) truth += std::max(0.0, slope(2 + (i + 0.5) / 100, 2 + (j + 0.5) / 100)) / 1e4;
    EXPECT_NEAR(both.cut, truth, 0.005 * truth);
    EXPECT_NEAR(both.fill, truth, 0.005 * truth);
    EXPECT_NEAR(both.net(), 0, 0.2);
    // Against its own plane nothing is left but noise; heights are relative to the plane, so that no cell is tilted.
    options.reference = plane_of(origin + Vec3d{10, 10, 0}, {-0.1, -0.05, 1});
    options.side = 1;
    const VolumeReport none = measure_volume(*cloud, options);
    EXPECT_NEAR(none.net(), 0, 5 * none.net_spread + 1e-3 * 256);
    EXPECT_LT(none.cut + none.fill, 0.5);
    EXPECT_EQ(none.cells, 256u);
    EXPECT_EQ(none.cells_without_data, 0u);
}

// Pyramid of volume base * height / 3 in a polygon that is not convex; two clouds.
TEST_F(Volumes, BetweenTwoClouds)
{
    const auto before = [](double x, double y) { return 0.02 * x - 0.03 * y; };
    const auto heap = [](double x, double y) {
        return std::max(0.0, 3 - std::max(std::fabs(x - 12), std::fabs(y - 12)));
    };
    const auto pit = [](double x, double y) { return std::max(0.0, 1 - std::max(std::fabs(x - 5), std::fabs(y - 5))); };
    const auto after = [&](double x, double y) { return before(x, y) + heap(x, y) - pit(x, y); };
    const auto old_cloud = measured_tree(folder_, "a", surface(before, 60000, 0.005, 1), origin);
    const auto new_cloud = measured_tree(folder_, "b", surface(after, 90000, 0.005, 2), origin);
    VolumeOptions options;
    options.before = old_cloud;
    options.polygon = at_origin({{1, 1, 0}, {19, 1, 0}, {19, 19, 0}, {8, 19, 0}, {8, 9, 0}, {1, 9, 0}});
    options.side = 0.25;
    const VolumeReport report = measure_volume(*new_cloud, options);
    EXPECT_NEAR(report.cut, 36, 0.4);  // 6 * 6 * 3 / 3
    EXPECT_NEAR(report.fill, 4.0 / 3, 0.4);
    EXPECT_NEAR(report.net(), 36 - 4.0 / 3, 0.2);
    EXPECT_GT(report.points[0], report.points[1]);
    EXPECT_LT(report.values()[0].uncertainty, 1);
    const double coarser = (report.cut_measured - report.fill_measured) - (report.cut_coarse - report.fill_coarse);
    const auto root = [](std::initializer_list<double> parts) {
        double squares = 0;
        for (const double part : parts) squares += part * part;
        return std::sqrt(squares);
    };
    EXPECT_NEAR(report.values()[0].uncertainty, root({report.net_spread, report.net_gaps, coarser}), 1e-12);
    EXPECT_NEAR(report.values()[1].uncertainty,
                root({report.cut_spread, report.cut_gaps, report.cut_measured - report.cut_coarse, report.excess}),
                1e-12);
    EXPECT_GT(report.net_spread, 1e-3);
    EXPECT_NE(coarser, 0);
    // In the other order the signs change.
    options.before = new_cloud;
    const VolumeReport back = measure_volume(*old_cloud, options);
    EXPECT_NEAR(back.cut, report.fill, 1e-9);
    EXPECT_NEAR(back.fill, report.cut, 1e-9);
}

TEST_F(Volumes, CellsWithoutPointsAreLeftOutOrInterpolated)
{
    const auto slope = [](double x, double y) { return 0.1 * x - 0.05 * y; };
    const auto has = [](double x, double y) { return std::hypot(x - 10, y - 10) > 3; };
    const auto cloud = measured_tree(folder_, "a", surface(slope, 80000, 0, 1, has), origin);
    VolumeOptions options;
    options.polygon = at_origin(square);
    options.reference.height = origin[2] - 5;
    options.side = 0.5;
    options.empty = EmptyCells::left_out;
    const VolumeReport left_out = measure_volume(*cloud, options);
    EXPECT_LT(left_out.area_without_data, pi * 9);  // the cells that lie in the hole as a whole
    EXPECT_GT(left_out.area_without_data, pi * std::pow(3 - 0.5 * std::sqrt(2.0), 2));
    EXPECT_NEAR(left_out.area_counted + left_out.area_without_data, 256, 1e-9);
    EXPECT_EQ(left_out.area_interpolated, 0);
    EXPECT_EQ(left_out.net_gaps, 0);
    EXPECT_EQ(left_out.cut_measured, left_out.cut);
    EXPECT_NEAR(left_out.covered(), left_out.area_counted / 256, 1e-12);
    ASSERT_EQ(left_out.notes().size(), 1u);
    EXPECT_NE(left_out.notes()[0].find("that of the 91"), std::string::npos) << left_out.notes()[0];
    // Over the same area: of a slope, wider cells have the same volume.
    EXPECT_NEAR(left_out.cut_coarse, left_out.cut, 1e-3 * left_out.cut);
    options.empty = VolumeOptions().empty;  // nothing is left out unasked
    const VolumeReport filled = measure_volume(*cloud, options);
    EXPECT_EQ(filled.area_without_data, left_out.area_without_data);
    EXPECT_EQ(filled.area_interpolated, left_out.area_without_data);
    EXPECT_EQ(filled.area_extrapolated, 0);
    const double truth = 256 * (5 + 0.1 * 10 - 0.05 * 10);
    EXPECT_NEAR(filled.net(), truth, 1e-3 * truth);
    EXPECT_NEAR(left_out.net(), truth - left_out.area_without_data * 5.5, 1e-2 * truth);
    // What is left out is contained in the uncertainty, as the mean height that there is; a fill there is none of.
    const std::vector<MeasureValue> values = left_out.values();
    EXPECT_LT(std::fabs(left_out.net() - truth), 1.1 * values[0].uncertainty);
    EXPECT_NEAR(values[0].uncertainty, left_out.area_without_data * left_out.net() / left_out.area_counted,
                0.02 * values[0].uncertainty);
    EXPECT_LT(std::fabs(left_out.cut - truth), 1.1 * values[1].uncertainty);
    // Where the reference goes through the surface the volume is about 0, and what is left out is not.
    options.empty = EmptyCells::left_out;
    const double usual = options.reference.height;
    options.reference.height += left_out.net() / left_out.area_counted;
    const VolumeReport around = measure_volume(*cloud, options);
    EXPECT_LT(std::fabs(around.net()), 0.01 * truth);
    double squares = 0;  // slopes of 0.1 and 0.05 over a square 16 wide
    for (const double slope : {0.1, 0.05}) squares += std::pow(slope * 16, 2) / 12;
    EXPECT_NEAR(around.values()[0].uncertainty, around.area_without_data * std::sqrt(squares),
                0.1 * around.values()[0].uncertainty);
    options.reference.height = usual;
    EXPECT_LT(filled.values()[0].uncertainty, values[0].uncertainty);
    EXPECT_TRUE(filled.notes().empty());
}

// Cells much narrower than the points are apart: what was 3.3 of 24 is about 24, and is reported as interpolated.
TEST_F(Volumes, OfCellsThatAreNarrowerThanTheSpacing)
{
    const auto roof = [](double, double y) { return 4 - 0.3 * std::fabs(y - 10); };
    const auto cloud = measured_tree(folder_, "a", surface(roof, 400, 0.02, 1), origin);  // 1 apart
    VolumeOptions options;
    options.polygon = at_origin({{6, 7, 0}, {14, 7, 0}, {14, 13, 0}, {6, 13, 0}});
    options.reference.height = origin[2] + 3;
    const double truth = 48 * (1 - 0.3 * 1.5);
    options.side = 0.25;
    const VolumeReport narrow = measure_volume(*cloud, options);
    EXPECT_LT(narrow.covered(), 0.2);
    const MeasureValue net = narrow.values()[0];
    EXPECT_NEAR(net.value, truth, 3 * net.uncertainty);
    EXPECT_LT(net.uncertainty, 0.2 * truth);
    ASSERT_FALSE(narrow.notes().empty());
    EXPECT_NE(narrow.notes()[0].find("less than half"), std::string::npos) << narrow.notes()[0];
    EXPECT_NE(narrow.notes()[0].find(" wide would have 9 points"), std::string::npos) << narrow.notes()[0];
    // The label of the measure says it as well.
    Measure measure;
    measure.kind = MeasureKind::volume;
    for (const Vec3d& p : options.polygon) measure.points.push_back({p, 0, 0, ""});
    measure.computed = narrow.values();
    EXPECT_NE(label_of(measure, "m").find(" % of the area has points"), std::string::npos) << label_of(measure, "m");
    // The usual side is that of the note.
    options.side = 0;
    const VolumeReport usual = measure_volume(*cloud, options);
    EXPECT_NEAR(usual.side, narrow.usual_side, 0.5 * usual.side);
    EXPECT_GT(usual.side, 2);
    EXPECT_LT(usual.side, 4.5);
    EXPECT_NEAR(usual.net(), truth, 3 * usual.values()[0].uncertainty);
    measure.computed = usual.values();
    EXPECT_EQ(label_of(measure, "m").find(" % of the area has points"), std::string::npos) << label_of(measure, "m");
}

// A side is chosen by the points that there are, wherever they lie in the polygon.
TEST_F(Volumes, GapsDoNotMakeTheUsualSideWider)
{
    const auto flat = [](double, double) { return 1.0; };
    const auto corner = [](double x, double y) { return x < 7 && y < 7; };
    VolumeOptions options;
    options.polygon = at_origin(square);
    options.reference.height = origin[2];
    const auto all = measured_tree(folder_, "a", surface(flat, 16000, 0, 1), origin);
    const auto part = measured_tree(folder_, "b", surface(flat, 1960, 0, 1, corner), origin);  // as dense
    const double side = measure_volume(*all, options).side;
    EXPECT_NEAR(side, std::sqrt(9 * 400.0 / 16000), 0.05);
    const VolumeReport report = measure_volume(*part, options);
    EXPECT_NEAR(report.side, side, 0.25 * side);
    EXPECT_LT(report.covered(), 0.2);
    EXPECT_GT(report.area_extrapolated, 100);
    EXPECT_EQ(report.points[0], measure_volume(*part,
                                               [&] {
                                                   VolumeOptions same = options;
                                                   same.side = 1;
                                                   return same;
                                               }())
                                    .points[0]);
}

// The uncertainty is the spread of volumes of clouds with the same surface and other noise.
TEST_F(Volumes, SpreadIsThatOfManyClouds)
{
    const auto flat = [](double, double) { return 0.0; };
    std::vector<double> volumes;
    double expected = 0;
    for (std::uint64_t seed = 0; seed < 24; ++seed) {
        const auto cloud = measured_tree(folder_, "a" + std::to_string(seed), surface(flat, 4000, 0.2, seed), origin);
        VolumeOptions options;
        options.polygon = at_origin(square);
        options.reference.height = origin[2] - 1;
        options.side = 2;
        const VolumeReport report = measure_volume(*cloud, options);
        volumes.push_back(report.net());
        expected += report.net_spread / 24;
    }
    double mean = 0, squares = 0;
    for (const double v : volumes) mean += v / 24;
    for (const double v : volumes) squares += (v - mean) * (v - mean);
    // 24 volumes know their spread to 15 %: three times that.
    EXPECT_NEAR(std::sqrt(squares / 23), expected, 0.45 * expected);
    EXPECT_NEAR(mean, 256, 4 * expected / std::sqrt(24.0));
}

TEST_F(Volumes, LowestAndHighestOfACell)
{
    std::vector<Vec3d> points;
    for (int i = 0; i < 40; ++i)
        for (int j = 0; j < 40; ++j)
            for (const double z : {1.0, 2.0, 6.0}) points.push_back(origin + Vec3d{0.25 + 0.5 * i, 0.25 + 0.5 * j, z});
    const auto cloud = measured_tree(folder_, "a", points, origin);
    VolumeOptions options;
    options.polygon = at_origin(square);
    options.reference.height = origin[2];
    options.side = 1;
    for (const auto& [kind, height] :
         {std::pair{CellHeight::lowest, 1.0}, {CellHeight::mean, 3.0}, {CellHeight::highest, 6.0}}) {
        options.height = kind;
        EXPECT_NEAR(measure_volume(*cloud, options).net(), height * 256, 1e-6);
    }
    // Points of a condition alone; the usual side gives a cell some points.
    options.where = {parse_condition("z<=" + std::to_string(origin[2] + 1.5))};
    options.height = CellHeight::mean;
    options.side = 0;
    const VolumeReport ground = measure_volume(*cloud, options);
    EXPECT_NEAR(ground.net(), ground.area_counted, 1e-6);
    EXPECT_GT(ground.side, 0.3);
    EXPECT_LT(ground.side, 3);
}

TEST_F(Volumes, WhatIsWrongIsRefused)
{
    const auto cloud = measured_tree(folder_, "a", surface([](double, double) { return 0.0; }, 2000, 0, 1), origin);
    const auto refusal = [&](const std::function<void(VolumeOptions&)>& change) -> std::string {
        VolumeOptions options;
        options.polygon = at_origin(square);
        change(options);
        try {
            measure_volume(*cloud, options);
        } catch (const Error& error) {
            return (error.code() == ErrorCode::cancelled ? "cancelled " : "") + std::string(error.what());
        }
        return "accepted";
    };
    EXPECT_EQ(refusal([](VolumeOptions&) {}), "accepted");
    EXPECT_NE(refusal([](VolumeOptions& o) { o.polygon.resize(2); }).find("takes 3"), std::string::npos);
    EXPECT_NE(refusal([](VolumeOptions& o) { std::swap(o.polygon[1], o.polygon[2]); }).find("no area"),
              std::string::npos);
    EXPECT_NE(refusal([](VolumeOptions& o) {
                  o.polygon[3] = origin + Vec3d{30, 3, 0};
              }).find("crosses"),
              std::string::npos);
    EXPECT_NE(refusal([](VolumeOptions& o) {
                  o.polygon = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
              }).find("no point of"),
              std::string::npos);
    EXPECT_NE(refusal([](VolumeOptions& o) { o.side = -1; }).find("side"), std::string::npos);
    EXPECT_NE(refusal([](VolumeOptions& o) { o.side = 1e308; }).find("out of range"), std::string::npos);
    EXPECT_NE(
        refusal([](VolumeOptions& o) { o.progress = [](const ProgressUpdate&) { return false; }; }).find("cancelled"),
        std::string::npos);
    // Heights for many small cells without points take a while, which can be cancelled too.
    EXPECT_NE(refusal([](VolumeOptions& o) {
                  o.side = 0.02;
                  o.progress = [](const ProgressUpdate& update) { return update.stage != "Filling gaps"; };
              }).find("cancelled"),
              std::string::npos);
    constexpr std::uint64_t few = std::uint64_t{4} << 20;
    const std::string memory = refusal([](VolumeOptions& o) {
        o.side = 1e-6;
        o.memory = few;
    });
    EXPECT_NE(memory.find("more than"), std::string::npos) << memory;
    // What it advises works.
    const std::size_t at = memory.find("a side of ", memory.find("take"));
    ASSERT_NE(at, std::string::npos) << memory;
    const double advised = std::stod(memory.substr(at + 10));
    EXPECT_EQ(refusal([&](VolumeOptions& o) {
                  o.side = advised;
                  o.memory = few;
              }),
              "accepted");
    for (const std::uint64_t none : {0, 1, 219})
        EXPECT_NE(refusal([&](VolumeOptions& o) { o.memory = none; }).find("do not hold one cell"), std::string::npos);
    EXPECT_EQ(refusal([](VolumeOptions& o) { o.memory = 220; }), "accepted");
    EXPECT_THROW(plane_of({0, 0, 0}, {1, 0, 0}), Error);
    EXPECT_THROW(plane_of({0, 0, 0}, {0, 0, 0}), Error);
}

TEST_F(Volumes, OfACloudWithoutPointsAreRefused)
{
    const auto none = measured_tree(folder_, "none", {}, origin);
    VolumeOptions options;
    options.polygon = at_origin(square);
    for (const bool with_side : {false, true}) {
        if (with_side) options.side = 0.5;
        try {
            measure_volume(*none, options);
            FAIL() << "accepted";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("none.pct has no points"), std::string::npos) << error.what();
        }
    }
}

}  // namespace
