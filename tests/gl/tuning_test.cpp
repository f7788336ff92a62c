// The tuned values of drawing: by name, and counted from what is made after they were set.
#include "pcm/gl/tuning.h"

#include "pcm/gl/draw/frame.h"
#include "pcm/gl/draw/smoothing.h"
#include "pcm/gl/tuned_values.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace pcm {
namespace {

// Sets a value until the end of a test.
class SetValue {
public:
    SetValue(const std::string& name, double value) : tuned_(named(name)), before_(tuned_.get()) { tuned_.set(value); }
    ~SetValue() { tuned_.set(before_); }
    SetValue(const SetValue&) = delete;
    SetValue& operator=(const SetValue&) = delete;

private:
    static TunedValue named(const std::string& name)
    {
        for (const TunedValue& value : gl_tuned_values())
            if (name == value.name()) return value;
        throw std::runtime_error("no tuned value " + name);
    }
    const TunedValue tuned_;
    const double before_;
};

TEST(GlTuning, EachValueHasAName)
{
    std::set<std::string> names;
    for (const TunedValue& value : gl_tuned_values()) names.insert(value.name());
    EXPECT_EQ(names.size(), gl_tuned_values().size());
    EXPECT_TRUE(names.count("gl.late.up"));
    EXPECT_TRUE(names.count("gl.radii.dispatch_pairs"));
}

TEST(GlTuning, ABudgetBeginsWithWhatIsSet)
{
    const std::uint64_t all = 1'000'000'000;
    EXPECT_EQ(FrameBudget().points(0, all), 300'000u);
    const SetValue first("gl.budget.first_points", 50'000), fewest("gl.budget.min_points", 70'000);
    EXPECT_EQ(FrameBudget().points(0, all), 70'000u);
    const SetValue rest("gl.budget.max_rest_ms", 5);
    FrameBudget budget;
    budget.measured_overhead(100);
    EXPECT_EQ(budget.at_rest(33), 5);
}

TEST(GlTuning, GapsAreFilledAsFarAsIsSet)
{
    CloudStyle style;
    style.splats = SplatMode::adaptive;
    EXPECT_EQ(fill_of(10, style), 14);
    EXPECT_EQ(fill_of(1000, style), 45);  // 1.4 * 32, in whole pixels
    const SetValue fill("gl.splats.fill", 2), most("gl.splats.max_fill", 20);
    EXPECT_EQ(fill_of(10, style), 20);
    EXPECT_EQ(fill_of(1000, style), 40);
}

TEST(GlTuning, AMeanHasFramesAsSet)
{
    const SetValue most("gl.smoothing.max_points", 1000), fewest("gl.smoothing.min_frames", 2);
    EXPECT_EQ(frames_worthwhile(16, 500), 2u);
    EXPECT_EQ(frames_worthwhile(16, 501), 1u);
}

}  // namespace
}  // namespace pcm
