#include "pcm/fit/tuning.h"

#include "pcm/fit/shape_fit.h"
#include "pcm/fit/tuned_values.h"
#include "tests/fit/fit_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace pcm {
namespace {

TunedValue tuned(const std::string& name)
{
    const std::vector<TunedValue> all = fit_tuned_values();
    const auto found = std::find_if(all.begin(), all.end(), [&](const TunedValue& one) { return name == one.name(); });
    if (found == all.end()) throw std::runtime_error("no tuned value " + name);
    return *found;
}

// Sets a value until the end of a test.
class SetValue {
public:
    SetValue(const std::string& name, double value) : tuned_(tuned(name)), before_(tuned_.get()) { tuned_.set(value); }
    ~SetValue() { tuned_.set(before_); }

private:
    const TunedValue tuned_;
    const double before_;
};

TEST(FitTuningTest, EachValueHasAName)
{
    std::set<std::string> names;
    for (const TunedValue& value : fit_tuned_values()) names.insert(value.name());
    EXPECT_EQ(names.size(), fit_tuned_values().size());
    EXPECT_EQ(tuned("fit.consensus.max_chance").get(), fit_tuning().consensus.max_chance);
    EXPECT_TRUE(tuned("fit.mixture.min_points").is_count());
}

TEST(FitTuningTest, WhatIsSetCountsFromTheNextFitOn)
{
    scenes::SceneOptions options;
    options.outliers = 0.5;
    const scenes::Scene scene = scenes::scene_of({ShapeKind::plane, {1, 2, 3}, {0, 0, 1}, 0, 0}, options);
    ShapeFitOptions asked;
    asked.threshold = 0.015;
    EXPECT_EQ(fit_shape(scene.points, asked).verdict, FitVerdict::good);
    {
        const SetValue no_chance("fit.consensus.max_chance", 0.001);
        EXPECT_EQ(fit_shape(scene.points, asked).issue, FitIssue::no_consensus);
    }
    EXPECT_EQ(fit_shape(scene.points, asked).verdict, FitVerdict::good);
}

TEST(FitTuningTest, CountsAreRounded)
{
    const SetValue points("fit.mixture.min_points", 70.6);
    EXPECT_EQ(fit_tuning().mixture.min_points, 71u);
}

}  // namespace
}  // namespace pcm
