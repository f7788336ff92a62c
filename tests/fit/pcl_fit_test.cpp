#include "pcm/fit/pcl_fit.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <random>
#include <stdexcept>

namespace pcm {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high)
{
    return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}
double gaussian(Random& random)
{
    const double r = std::sqrt(-2 * std::log(uniform(random, 1e-12, 1)));
    return r * std::cos(uniform(random, 0, 2 * pi));
}

Shape truth_of(ShapeKind kind, const Vec3d& offset)
{
    Shape shape;
    shape.kind = kind;
    shape.point = offset + Vec3d{0.3, -0.2, 1.1};
    shape.axis = normalised({0.2, 0.3, 1});
    if (kind == ShapeKind::sphere) shape.axis = {0, 0, 1};
    if (kind == ShapeKind::cylinder || kind == ShapeKind::sphere) shape.radius = 0.7;
    if (kind == ShapeKind::cone) shape.second = 0.4;
    return shape;
}

struct Cloud {
    FitPoints points;
    Shape truth;
};

// 1500 points with their normals; noise of 2 mm.
Cloud cloud_of(ShapeKind kind, double outliers, const Vec3d& offset = {})
{
    Random random(5);
    Cloud cloud{{}, truth_of(kind, offset)};
    Shape& t = cloud.truth;
    const Vec3d x = normalised(cross(t.axis, {1, 0, 0})), y = cross(t.axis, x);
    cloud.points.origin = offset;
    for (int i = 0; i < 1500; ++i) {
        const double a = uniform(random, 0, 2 * pi), u = uniform(random, -1, 1), v = uniform(random, -1, 1);
        const Vec3d out = std::cos(a) * x + std::sin(a) * y;
        if (uniform(random, 0, 1) < outliers) {
            Vec3d p{uniform(random, -1.5, 1.5), uniform(random, -1.5, 1.5), uniform(random, 0, 2.5)};
            cloud.points.add(offset + p, out);
            continue;
        }
        Vec3d p = t.point, n = out;
        if (kind == ShapeKind::plane) p = p + u * x + v * y, n = t.axis;
        if (kind == ShapeKind::cylinder) p = p + t.radius * out + u * t.axis;
        if (kind == ShapeKind::sphere) n = std::sqrt(1 - u * u) * out + u * t.axis, p = p + t.radius * n;
        if (kind == ShapeKind::cone) {
            const double h = 0.5 + 0.5 * (u + 1);
            p = p + h * t.axis + (h * std::tan(t.second)) * out;
            n = std::cos(t.second) * out - std::sin(t.second) * t.axis;
        }
        cloud.points.add(p + (0.002 * gaussian(random)) * n, n);
    }
    return cloud;
}

ShapeFitOptions options_for(ShapeKind kind, Estimator estimator)
{
    ShapeFitOptions options;
    options.kind = kind;
    options.estimator = estimator;
    options.threshold = 0.01;
    options.backend = FitBackend::pcl;
    return options;
}

// Two shapes are near where the places of one are on the other.
void expect_near(const Shape& found, const Shape& truth, double tolerance)
{
    EXPECT_EQ(found.kind, truth.kind);
    EXPECT_NEAR(found.radius, truth.radius, tolerance);
    EXPECT_NEAR(found.second, truth.second, tolerance);
    if (truth.kind == ShapeKind::plane) {
        EXPECT_LT(distance_to(found, truth.point), tolerance);
    } else if (truth.kind == ShapeKind::cylinder) {
        EXPECT_LT(length(cross(found.axis, truth.point - found.point)), tolerance);
    } else {
        EXPECT_LT(length(found.point - truth.point), 2 * tolerance);
    }
    if (truth.kind == ShapeKind::cone) {
        EXPECT_GT(dot(found.axis, truth.axis), 1 - tolerance);  // from the apex inwards
    } else if (truth.kind != ShapeKind::sphere) {
        EXPECT_GT(std::fabs(dot(found.axis, truth.axis)), 1 - tolerance);
    }
}

bool is_loaded(const std::string& library)
{
    std::ifstream maps("/proc/self/maps");
    const std::string all{std::istreambuf_iterator<char>(maps), {}};
    return all.find(library) != std::string::npos;
}

// First of all: the other tests load it.
TEST(PclModule, IsLoadedOnlyWhenItIsChosen)
{
    if (is_loaded("libpcm_pcl")) GTEST_SKIP() << "another test has loaded it";
    ShapeFitOptions options = options_for(ShapeKind::plane, Estimator::msac);
    options.backend = FitBackend::own;
    EXPECT_TRUE(fit_shape(cloud_of(ShapeKind::plane, 0.3).points, options).has_shape());
    EXPECT_FALSE(is_loaded("libpcm_pcl"));
    EXPECT_FALSE(is_loaded("libpcl_"));
    if (const std::string why = why_no_pcl(); !why.empty()) GTEST_SKIP() << why;
    EXPECT_TRUE(is_loaded("libpcm_pcl"));
    EXPECT_TRUE(is_loaded("libpcl_sample_consensus"));
}

class PclFit : public testing::Test {
protected:
    void SetUp() override
    {
        if (const std::string why = why_no_pcl(); !why.empty()) GTEST_SKIP() << why;
    }
};

TEST_F(PclFit, EveryEstimatorFindsEveryShapeNearTheOriginAndOnTheMap)
{
    for (const Vec3d& offset : {Vec3d{0, 0, 0}, Vec3d{5e5, 4.8e6, 100}})
        for (const ShapeKind kind : {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere, ShapeKind::cone})
            for (const EstimatorTraits& row : estimators()) {
                SCOPED_TRACE(std::string(traits_of(kind).name) + " " + row.name);
                const Cloud cloud = cloud_of(kind, 0.3, offset);
                const ShapeFit fit = fit_shape(cloud.points, options_for(kind, row.estimator));
                ASSERT_TRUE(fit.has_shape()) << fit.message;
                expect_near(fit.shape, cloud.truth, 0.02);
                EXPECT_GT(fit.iterations, 0u);
                EXPECT_LT(fit.iterations, 2000u);
                EXPECT_EQ(fit.is_inlier.size(), cloud.points.size());
                EXPECT_GT(fit.inliers, 600u);
                EXPECT_EQ(fit.threshold, 0.01);
            }
}

TEST_F(PclFit, ErrorsAreThoseOfOurSums)
{
    const Cloud cloud = cloud_of(ShapeKind::sphere, 0.2);
    const ShapeFit fit = fit_shape(cloud.points, options_for(ShapeKind::sphere, Estimator::msac));
    EXPECT_EQ(fit.verdict, FitVerdict::good) << fit.message;
    // 1200 points of 2 mm determine a radius to 2 mm / sqrt(1200).
    EXPECT_NEAR(fit.errors.radius, 0.002 / std::sqrt(1200.0), 1e-5);
    EXPECT_NEAR(fit.rms, 0.002, 0.001);
    std::uint64_t inliers = 0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        EXPECT_EQ(fit.is_inlier[i] != 0, distance_to(fit.shape, cloud.points.source(i)) <= 0.01);
        inliers += fit.is_inlier[i];
    }
    EXPECT_EQ(inliers, fit.inliers);
}

TEST_F(PclFit, NormalsThatDifferTakeNoPart)
{
    const Cloud cloud = cloud_of(ShapeKind::cylinder, 0.5);
    ShapeFitOptions options = options_for(ShapeKind::cylinder, Estimator::msac);
    options.normal_angle = 0.2;
    const ShapeFit fit = fit_shape(cloud.points, options);
    ASSERT_TRUE(fit.has_shape()) << fit.message;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        const double cosine = std::fabs(dot(cloud.points.normal(i), normal_at(fit.shape, cloud.points.source(i))));
        if (fit.is_inlier[i]) EXPECT_GE(cosine, std::cos(0.2));
    }
}

TEST_F(PclFit, PointsWithoutANormalAreNotCompared)
{
    Cloud cloud = cloud_of(ShapeKind::cylinder, 0.3);
    for (std::size_t i = 0; i < cloud.points.size(); i += 10)
        cloud.points.nx[i] = cloud.points.ny[i] = cloud.points.nz[i] = 0;
    ShapeFitOptions options = options_for(ShapeKind::cylinder, Estimator::msac);
    options.normal_angle = 0.2;
    const ShapeFit fit = fit_shape(cloud.points, options);
    ASSERT_TRUE(fit.has_shape()) << fit.message;
    for (std::size_t i = 0; i < cloud.points.size(); i += 10)
        EXPECT_EQ(fit.is_inlier[i] != 0, distance_to(fit.shape, cloud.points.source(i)) <= fit.threshold) << i;
}

// A tenth of the points never fits where half of them are outliers: PCL by itself would draw samples for ever.
TEST_F(PclFit, SearchesThatPclWouldNeverEndDoEnd)
{
    const Cloud cloud = cloud_of(ShapeKind::plane, 0.5);
    for (const Estimator estimator : {Estimator::rransac, Estimator::rmsac}) {
        ShapeFitOptions options = options_for(ShapeKind::plane, estimator);
        options.iterations = 300;
        PclOptions pcl;
        pcl.pretest = 150;
        EXPECT_LE(pcl_shape(cloud.points, options, pcl).samples, 300u);
        options.iterations = 2000000000;
        options.seconds = 0.2;
        if (estimator == Estimator::rransac) EXPECT_FALSE(pcl_shape(cloud.points, options, pcl).found);
    }
}

TEST_F(PclFit, EveryEstimatorEndsAtTheNumberOfSamplesAndAtTheTimeLimit)
{
    const Cloud cloud = cloud_of(ShapeKind::sphere, 0.97);
    for (const EstimatorTraits& row : estimators()) {
        SCOPED_TRACE(row.name);
        ShapeFitOptions options = options_for(ShapeKind::sphere, row.estimator);
        options.probability = 0.999999999;
        options.iterations = 40;
        EXPECT_LE(pcl_shape(cloud.points, options).samples, 40u);
        options.iterations = 1000000000;
        options.seconds = 0.05;
        EXPECT_LT(fit_shape(cloud.points, options).seconds, 5);
    }
}

TEST_F(PclFit, IsCancelledAndPassesOnWhatTheCallerThrows)
{
    const Cloud cloud = cloud_of(ShapeKind::plane, 0.5);
    PclOptions pcl;
    pcl.pretest = 150;
    ShapeFitOptions options = options_for(ShapeKind::plane, Estimator::rransac);
    options.iterations = 2000000000;
    options.progress = [](const ProgressUpdate&) { return false; };
    try {
        pcl_shape(cloud.points, options, pcl);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
    options.progress = [](const ProgressUpdate&) -> bool { throw std::out_of_range("of the caller"); };
    EXPECT_THROW(pcl_shape(cloud.points, options, pcl), std::out_of_range);
}

TEST_F(PclFit, TheSeedDecides)
{
    const Cloud cloud = cloud_of(ShapeKind::plane, 0.3);
    PclOptions raw;
    raw.optimise = false;
    for (const EstimatorTraits& row : estimators()) {
        SCOPED_TRACE(row.name);
        ShapeFitOptions options = options_for(ShapeKind::plane, row.estimator);
        const Shape one = pcl_shape(cloud.points, options, raw).shape,
                    again = pcl_shape(cloud.points, options, raw).shape;
        EXPECT_EQ(one.axis, again.axis);
        options.seed = 2;
        EXPECT_NE(one.axis, pcl_shape(cloud.points, options, raw).shape.axis);
    }
}

TEST_F(PclFit, ItsLeastSquaresHelps)
{
    const Cloud cloud = cloud_of(ShapeKind::sphere, 0.3);
    const ShapeFitOptions options = options_for(ShapeKind::sphere, Estimator::msac);
    PclOptions raw;
    raw.optimise = false;
    const auto error = [&](const PclShape& found) { return length(found.shape.point - cloud.truth.point); };
    EXPECT_LT(error(pcl_shape(cloud.points, options)), 0.5 * error(pcl_shape(cloud.points, options, raw)));
}

// PCL multiplies MLESAC's threshold by the median distance of the points, here some 10 m, and so would take both planes
// for one.
TEST_F(PclFit, TheThresholdOfMlesacIsADistance)
{
    FitPoints points;
    Random random(3);
    for (int i = 0; i < 1000; ++i) {
        const double z = (i % 5 < 3 ? 0 : 0.1) + 0.001 * gaussian(random);
        points.add({uniform(random, -20, 20), uniform(random, -20, 20), z});
    }
    const PclShape found = pcl_shape(points, options_for(ShapeKind::plane, Estimator::mlesac));
    ASSERT_TRUE(found.found);
    EXPECT_LT(distance_to(found.shape, {0, 0, 0}), 0.002);
}

TEST_F(PclFit, RadiiOutOfRangeAreNotConsidered)
{
    const Cloud cloud = cloud_of(ShapeKind::cylinder, 0.3);
    ShapeFitOptions options = options_for(ShapeKind::cylinder, Estimator::ransac);
    options.iterations = 200;
    PclOptions raw;
    raw.optimise = false;
    options.least_radius = 1;
    const PclShape larger = pcl_shape(cloud.points, options, raw);
    if (larger.found) EXPECT_GE(larger.shape.radius, 1);
    options.least_radius = 0;
    options.largest_radius = 0.5;
    const PclShape smaller = pcl_shape(cloud.points, options, raw);
    if (smaller.found) EXPECT_LE(smaller.shape.radius, 0.5);
}

// PCL by itself takes a first sample whose radius is out of range for the best one of all.
TEST_F(PclFit, RadiiInRangeAreFoundByEveryEstimator)
{
    for (const ShapeKind kind : {ShapeKind::cylinder, ShapeKind::sphere})
        for (const EstimatorTraits& row : estimators())
            for (std::uint64_t seed = 1; seed <= 8; ++seed) {
                SCOPED_TRACE(std::string(traits_of(kind).name) + " " + row.name);
                const Cloud cloud = cloud_of(kind, 0.5);
                ShapeFitOptions options = options_for(kind, row.estimator);
                options.least_radius = 0.65;
                options.largest_radius = 0.75;
                options.seed = seed;
                const PclShape found = pcl_shape(cloud.points, options);
                ASSERT_TRUE(found.found);
                EXPECT_NEAR(found.shape.radius, 0.7, 0.05);
            }
}

TEST_F(PclFit, TheProbabilityDecidesWhenItEnds)
{
    const Cloud cloud = cloud_of(ShapeKind::sphere, 0.4);
    for (const Estimator estimator : {Estimator::ransac, Estimator::msac, Estimator::mlesac}) {
        ShapeFitOptions options = options_for(ShapeKind::sphere, estimator);
        options.probability = 0.5;
        const std::uint64_t few = pcl_shape(cloud.points, options).samples;
        options.probability = 0.999999;
        EXPECT_GT(pcl_shape(cloud.points, options).samples, 3 * few);
    }
}

TEST_F(PclFit, NormalsAreEstimatedWhereThereAreNone)
{
    Cloud cloud = cloud_of(ShapeKind::cylinder, 0.1);
    cloud.points.nx.clear();
    cloud.points.ny.clear();
    cloud.points.nz.clear();
    const PclShape found = pcl_shape(cloud.points, options_for(ShapeKind::cylinder, Estimator::msac));
    ASSERT_TRUE(found.found);
    expect_near(found.shape, cloud.truth, 0.05);
}

TEST_F(PclFit, PointsThatMakeNoShapeAreRefused)
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const ShapeKind kind : {ShapeKind::plane, ShapeKind::cylinder, ShapeKind::sphere, ShapeKind::cone})
        for (const EstimatorTraits& row : estimators()) {
            SCOPED_TRACE(std::string(traits_of(kind).name) + " " + row.name);
            const ShapeFitOptions options = options_for(kind, row.estimator);
            const auto refused = [&](FitPoints points) {
                points.origin = {};
                const ShapeFit fit = pcl_fit(points, options);
                EXPECT_FALSE(fit.message.empty());
                EXPECT_EQ(fit.inliers, 0u);
                return fit.verdict == FitVerdict::refused ? fit.issue : FitIssue::none;
            };
            EXPECT_EQ(refused({}), FitIssue::no_consensus);
            EXPECT_EQ(refused(FitPoints::of({{1, 2, 3}})), FitIssue::no_consensus);
            EXPECT_EQ(refused(FitPoints::of(std::vector<Vec3d>(20, Vec3d{1, 2, 3}))), FitIssue::no_consensus);
            EXPECT_EQ(refused(FitPoints::of({{1, 2, 3}, {1, 2, nan}, {4, 5, 6}, {1, 0, 0}})), FitIssue::not_finite);
        }
}

TEST_F(PclFit, HasNoTorus)
{
    const Cloud cloud = cloud_of(ShapeKind::plane, 0.3);
    try {
        fit_shape(cloud.points, options_for(ShapeKind::torus, Estimator::msac));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::unsupported);
        EXPECT_NE(std::string(error.what()).find("torus"), std::string::npos);
    }
}

TEST(PclAbsent, IsExplained)
{
    if (why_no_pcl().empty()) GTEST_SKIP() << "PCL is here";
    try {
        fit_shape(cloud_of(ShapeKind::plane, 0.3).points, options_for(ShapeKind::plane, Estimator::msac));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::unsupported);
        EXPECT_NE(std::string(error.what()).find("libpcm_pcl.so"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace pcm
