#include "pcm/filter/outliers.h"

#include "pcm/filter/value_file.h"
#include "pcm/point_cloud.h"
#include "pcm/system/error.h"
#include "pcm/tree/verify.h"
#include "pcm/tree/verify_levels.h"
#include "tests/filter/oracle.h"
#include "tests/outcome.h"
#include "tests/sanitizers.h"

#include <set>

namespace {

using namespace pcm;
using namespace pcm::test;
namespace fs = std::filesystem;

// A surface, some noise about it, and strays.
Vec3d noisy(double u, double v, double w)
{
    const double z = 0.3 * std::sin(3 * u);
    if (w < 0.97) return {10 * u, 8 * v, z + 0.01 * w};
    if (w < 0.99) return {10 * u, 8 * v, z + 30 * (w - 0.97)};
    return {14 * u - 2, 12 * v - 2, 500 * (w - 0.99) - 2};
}

using Positions = std::multiset<Vec3i>;

class Outliers : public testing::Test {
protected:
    void build(const std::function<Vec3d(double, double, double)>& f, std::size_t count = 3000)
    {
        fs::remove_all(tree_);
        build_small(cloud_of(count, 41, f), tree_);
    }

    static Positions positions_of(const fs::path& tree)
    {
        const Oracle oracle(tree);
        Positions positions;
        for (const OraclePoint& p : oracle.points) positions.insert(p.q);
        return positions;
    }

    // Mean distances by comparing all pairs.
    static std::vector<double> mean_distances(const Oracle& oracle, std::size_t k)
    {
        std::vector<double> all;
        for (std::size_t i = 0; i < oracle.points.size(); ++i) {
            const OracleNeighbours n = oracle.neighbours(i, k);
            double sum = 0;
            for (const double square : n.squared) sum += std::sqrt(square);
            all.push_back(n.count() ? sum / double(n.count()) : 0);
        }
        return all;
    }

    static double median(std::vector<double> values)
    {
        std::sort(values.begin(), values.end());
        const std::size_t n = values.size();
        return n % 2 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
    }

    // The positions that stay.
    static Positions expected(const Oracle& oracle, const OutlierOptions& options)
    {
        std::vector<double> values;
        double limit = 0;
        if (options.method == OutlierMethod::radius) {
            for (std::size_t i = 0; i < oracle.points.size(); ++i)
                values.push_back(-double(oracle.neighbours(i, options.neighbours, options.radius).count()));
            limit = -double(options.neighbours);
        } else {
            values = mean_distances(oracle, options.neighbours);
            long double sum = 0, squares = 0;
            for (const double v : values) sum += v;
            const long double mean = sum / values.size();
            for (const double v : values) squares += (v - mean) * (v - mean);
            limit = double(mean + options.factor * std::sqrt(squares / values.size()));
            if (options.method == OutlierMethod::robust) {
                const double m = median(values);
                std::vector<double> deviations;
                for (const double v : values) deviations.push_back(std::fabs(v - m));
                limit = m + options.factor * 1.4826 * median(deviations);
            }
        }
        Positions positions;
        for (std::size_t i = 0; i < values.size(); ++i)
            if (!(values[i] > limit)) positions.insert(oracle.points[i].q);
        return positions;
    }

    void expect_removed_as_by_comparing_all_pairs(OutlierOptions options)
    {
        options.threads = 2;
        const Oracle before(tree_);
        const Positions wanted = expected(before, options);
        fs::remove_all(folder_ / "labelled.pct");
        fs::copy(tree_, folder_ / "labelled.pct", fs::copy_options::recursive);

        options.count_only = true;
        const std::uint64_t count = before.points.size() - wanted.size();
        EXPECT_EQ(remove_outliers(tree_, options).outliers, count);
        EXPECT_TRUE(positions_of(tree_).size() == before.points.size());
        options.count_only = false;
        const Stopwatch watch;
        const OutlierReport report = remove_outliers(tree_, options);
        EXPECT_EQ(report.outliers, count);
        expect_outcome(report.outcome, before.points.size(), wanted.size(), watch);
        EXPECT_TRUE(positions_of(tree_) == wanted);
        EXPECT_TRUE(verify_tree(tree_, 1).faults.empty());
        EXPECT_TRUE(verify_levels(*Tree::open(tree_), 1).faults.empty());

        options.label = true;
        const OutlierReport labelled = remove_outliers(folder_ / "labelled.pct", options);
        EXPECT_EQ(labelled.outliers, count);
        expect_outcome(labelled.outcome, before.points.size(), before.points.size(), watch);
        const Oracle after(folder_ / "labelled.pct");
        Positions good;
        for (const OraclePoint& p : after.points) {
            const double label = after.value(p, "outlier");
            EXPECT_TRUE(label == 0 || label == 1);
            if (label == 0) good.insert(p.q);
        }
        EXPECT_TRUE(good == wanted);
        EXPECT_TRUE(verify_tree(folder_ / "labelled.pct", 1).faults.empty());
    }

    const TemporaryFolder folder_;
    const fs::path tree_ = folder_ / "cloud.pct";
};

// Not under the thread sanitizer: its threads are those that other tests of the room watch.
TEST_F(Outliers, PCM_NOT_UNDER_THREAD(AreThoseOfComparingAllPairsAtAnyOffset))
{
    for (const Vec3d& origin : {Vec3d{0, 0, 0}, Vec3d{500000, 4800000, 120}})
        for (const OutlierMethod method : {OutlierMethod::statistical, OutlierMethod::robust, OutlierMethod::radius}) {
            SCOPED_TRACE(std::to_string(int(method)) + " at " + std::to_string(origin[1]));
            build([&](double u, double v, double w) { return origin + noisy(u, v, w); });
            OutlierOptions options;
            options.method = method;
            options.neighbours = method == OutlierMethod::radius ? 4 : 16;
            options.factor = method == OutlierMethod::robust ? 6 : 1;
            options.radius = 0.4;
            const std::uint64_t before = Tree::open(tree_)->info().points;
            expect_removed_as_by_comparing_all_pairs(options);
            const std::uint64_t removed = before - Tree::open(tree_)->info().points;
            EXPECT_GT(removed, 5u);
            EXPECT_LT(removed, 400u);
        }
}

TEST_F(Outliers, PCM_NOT_UNDER_THREAD(AFarStrayDoesNotHideTheOthersFromTheRobustMethod))
{
    const auto with_stray = [](double u, double v, double w) {
        return u < 0.0005 ? Vec3d{1e9, -1e9, 1e9} : noisy(u, v, w);
    };
    build(with_stray);
    OutlierOptions options;
    options.method = OutlierMethod::robust;
    options.factor = 6;
    const OutlierReport report = remove_outliers(tree_, options);
    EXPECT_GT(report.outliers, 20u);
    EXPECT_LT(report.threshold, 3);
    EXPECT_LT(Tree::open(tree_)->info().bounds().max[0], 100);
    build(with_stray);
    options.method = OutlierMethod::statistical;
    EXPECT_LT(remove_outliers(tree_, options).outliers, 5u);  // hidden
    build(with_stray);
    options.method = OutlierMethod::robust;
    expect_removed_as_by_comparing_all_pairs(options);
}

TEST_F(Outliers, OfCloudsWithoutAny)
{
    OutlierOptions options;
    const auto none = [&](const char* what) {
        for (const OutlierMethod method : {OutlierMethod::statistical, OutlierMethod::robust}) {
            options.method = method;
            const OutlierReport report = remove_outliers(tree_, options);
            EXPECT_EQ(report.outliers, 0u) << what;
            EXPECT_TRUE(std::isfinite(report.threshold)) << what;
        }
    };
    build([](double, double, double) { return Vec3d{1, 2, 3}; }, 1);
    none("one point");
    build([](double, double, double) { return Vec3d{1, 2, 3}; }, 100);
    none("one place");
    // Corners of a cube: all mean distances are equal, and so is the threshold.
    std::size_t corner = 0;
    build(
        [&](double, double, double) {
            const std::size_t c = corner++;
            return Vec3d{double(c & 1), double(c >> 1 & 1), double(c >> 2 & 1)};
        },
        8);
    options.neighbours = 3;
    none("a cube");
}

TEST_F(Outliers, OnALatticeTheRobustMethodFindsAStrayAndKeepsTheBorder)
{
    std::size_t number = 0;
    build(
        [&](double, double, double) {
            const std::size_t n = number++;
            return n == 0 ? Vec3d{20, 20, 9} : Vec3d{double(n % 50), double(n / 50), 0};
        },
        2500);
    OutlierOptions options;
    options.method = OutlierMethod::robust;
    options.neighbours = 8;
    options.factor = 10;
    EXPECT_EQ(remove_outliers(tree_, options).outliers, 1u);
    EXPECT_EQ(Tree::open(tree_)->info().bounds().max[2], 0);
}

// Most points have a twin at their place, so that most distances to the nearest are 0.
TEST_F(Outliers, WhereMostPointsAreDoubledTheRobustMethodRemovesNoneAndSaysSo)
{
    const auto doubled = [&](std::size_t twins) {
        std::size_t number = 0;
        build(
            [&](double, double, double) {
                const std::size_t n = number++;
                const std::size_t place = n < 2 * twins ? n / 2 : n - twins;
                return Vec3d{double(place % 30), double(place / 30), n == 999 ? 500.0 : 0.0};
            },
            1000);
    };
    OutlierOptions options;
    options.method = OutlierMethod::robust;
    options.neighbours = 1;
    doubled(300);  // 600 of 1000
    const OutlierReport report = remove_outliers(tree_, options);
    EXPECT_EQ(report.outliers, 0u);
    EXPECT_EQ(report.centre, 0);
    ASSERT_EQ(report.notes.size(), 1u);
    EXPECT_NE(report.notes[0].find("more than half of the points"), std::string::npos);
    // With fewer twins, or further neighbours, distances say what a stray is.
    doubled(200);
    const OutlierReport fewer = remove_outliers(tree_, options);
    EXPECT_EQ(fewer.outliers, 1u);
    EXPECT_EQ(fewer.centre, 1);
    EXPECT_TRUE(fewer.notes.empty());
    doubled(300);
    options.neighbours = 2;
    options.factor = 12;
    const OutlierReport further = remove_outliers(tree_, options);
    EXPECT_EQ(further.outliers, 1u);
    EXPECT_GT(further.centre, 0);
    EXPECT_TRUE(further.notes.empty());
}

// More than half of the mean distances are equal: a tenth of them is the deviation.
TEST_F(Outliers, WithoutADeviationATenthOfTheMedianIs)
{
    std::size_t number = 0;
    build(
        [&](double, double, double) {
            const std::size_t n = number++;
            return Vec3d{n == 99 ? 110.0 : double(n), 0, 0};
        },
        100);  // 0 1 ... 98, 110
    OutlierOptions options;
    options.method = OutlierMethod::robust;
    options.neighbours = 2;
    options.count_only = true;
    const auto outliers = [&](double factor) {
        options.factor = factor;
        const OutlierReport report = remove_outliers(tree_, options);
        EXPECT_EQ(report.centre, 1);
        EXPECT_DOUBLE_EQ(report.deviation, 0.1);
        EXPECT_DOUBLE_EQ(report.threshold, 1 + 0.1 * factor);
        return report.outliers;
    };
    EXPECT_EQ(outliers(4), 3u);  // the ends of the row, 1.5 each, and the stray
    EXPECT_EQ(outliers(6), 1u);
    EXPECT_EQ(outliers(200), 0u);
}

TEST_F(Outliers, LabelsAreSetAgain)
{
    build(noisy);
    OutlierOptions options;
    options.label = true;
    options.method = OutlierMethod::radius;
    options.radius = 1e-9;  // all points
    EXPECT_EQ(remove_outliers(tree_, options).outliers, 3000u);
    options.method = OutlierMethod::statistical;
    options.factor = 1e9;
    EXPECT_EQ(remove_outliers(tree_, options).outliers, 0u);
    const Oracle oracle(tree_);
    for (const OraclePoint& p : oracle.points) EXPECT_EQ(oracle.value(p, "outlier"), 0);
    EXPECT_EQ(oracle.tree->info().schema.size(), 1u);
}

TEST_F(Outliers, ACancelledRunLeavesTheTree)
{
    build(noisy, 6000);
    const auto before = Tree::open(tree_)->info();
    for (const bool label : {false, true})
        for (const double stop : {0.1, 0.5, 0.86, 0.9}) {
            OutlierOptions options;
            options.label = label;
            options.factor = 1;
            options.progress = [&](const ProgressUpdate& update) { return update.fraction < stop; };
            try {
                remove_outliers(tree_, options);
                FAIL() << "not cancelled at " << stop;
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::cancelled) << error.what();
            }
            EXPECT_EQ(Tree::open(tree_)->info().generation, before.generation);
            EXPECT_TRUE(verify_tree(tree_, 1).faults.empty());
            for (const auto& entry : fs::directory_iterator(tree_))
                EXPECT_NE(entry.path().filename(), update_scratch_name);
        }
}

TEST_F(Outliers, OptionsOutOfRangeAreRefused)
{
    build(noisy, 500);
    const auto refused = [&](const std::function<void(OutlierOptions&)>& change) {
        OutlierOptions options;
        change(options);
        try {
            remove_outliers(tree_, options);
        } catch (const Error& error) {
            return error.code() == ErrorCode::invalid_argument;
        }
        return false;
    };
    EXPECT_TRUE(refused([](auto& options) { options.neighbours = 0; }));
    EXPECT_TRUE(refused([](auto& options) { options.factor = std::nan(""); }));
    EXPECT_TRUE(refused([](auto& options) { options.factor = HUGE_VAL; }));
    // Most points are nearer to their neighbours than that, and would go.
    EXPECT_TRUE(refused([](auto& options) { options.factor = -1; }));
    EXPECT_TRUE(refused([](auto& options) { options.factor = 0; }));
    EXPECT_TRUE(refused([](auto& options) { options.factor = -1, options.method = OutlierMethod::robust; }));
    EXPECT_FALSE(refused([](auto& options) {
        options.factor = -1, options.method = OutlierMethod::radius, options.radius = 1e9, options.neighbours = 1;
    }));
    EXPECT_TRUE(refused([](auto& options) { options.method = OutlierMethod::radius; }));
    EXPECT_TRUE(refused([](auto& options) { options.label = options.count_only = true; }));
    EXPECT_FALSE(refused([](auto&) {}));
    const auto cloud = PointCloud::open(tree_, {}, Access::write);
    cloud->add_attribute({"outlier", ScalarType::f32, 1, 1, 0, ""});
    cloud->close();
    EXPECT_TRUE(refused([](auto& options) { options.label = true; }));
}

TEST_F(Outliers, ValueFilesKeepANumberForEachPoint)
{
    build(noisy, 4000);
    const Oracle oracle(tree_);
    ValueFile file(*oracle.tree, tree_);
    ASSERT_EQ(file.size(), 4000u);
    // Every third point, then the others.
    for (const bool third : {true, false})
        for (NodeId id = 0; id < oracle.tree->nodes().size(); ++id) {
            std::vector<std::uint32_t> indices;
            std::vector<double> values;
            for (std::uint32_t i = 0; i < oracle.tree->node(id).points; ++i)
                if ((i % 3 == 0) == third) indices.push_back(i), values.push_back(id + i / 1e6);
            file.set(id, indices, values.data());
        }
    std::vector<double> all;
    for (NodeId id = 0; id < oracle.tree->nodes().size(); ++id) {
        const std::vector<double> values = file.get(id);
        for (std::uint32_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i], id + i / 1e6);
        all.insert(all.end(), values.begin(), values.end());
    }
    std::size_t seen = 0;
    file.for_each([&](const double* values, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(values[i], all[seen++]);
    });
    EXPECT_EQ(seen, all.size());
}

}  // namespace
