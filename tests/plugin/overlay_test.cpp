// The text about the clouds in a view.
#include "plugin/overlay/overlay.h"

#include <gtest/gtest.h>

using namespace pcm;
using namespace pcm::host;

namespace {

FrameReport report_of(std::uint64_t drawn, bool refining, std::size_t clouds = 1)
{
    FrameReport report;
    report.points_drawn = drawn;
    report.refining = refining;
    report.full_resolution = !refining;
    report.measured_ms = 20.8;
    report.samples = 4;
    report.clouds.resize(clouds);
    return report;
}

QString text_of(const FrameReport& report, std::initializer_list<std::uint64_t> points, bool detailed = false)
{
    std::vector<OverlayCloud> clouds;
    for (const std::uint64_t n : points) clouds.push_back({"cloud " + QString::number(clouds.size()), n});
    const OverlayDetails details{1.4, {{"video memory", 36u << 20, 512u << 20, 81, 19}}};
    return overlay_text(report, clouds, detailed ? &details : nullptr);
}

TEST(Overlay, AmountsShareAUnit)
{
    EXPECT_EQ(amount_text(2'000'000, 20'000'000), "2.0 of 20 M points");
    EXPECT_EQ(amount_text(350'000, 2'096'574), "0.3 of 2.1 M points");
    EXPECT_EQ(amount_text(1'234, 999'999), "1,234 of 999,999 points");
    EXPECT_EQ(amount_text(9'960'000, 12'000'000), "10 of 12 M points");
    EXPECT_EQ(amount_text(200'000'000, 2'500'000'000), "0.2 of 2.5 billion points");
}

TEST(Overlay, SaysHowMuchIsShownInOneLine)
{
    EXPECT_EQ(text_of(report_of(2'000'000, true), {20'000'000}), "2.0 of 20 M points, loading…");
    EXPECT_EQ(text_of(report_of(20'000'000, false), {20'000'000}), "all points shown");
    EXPECT_EQ(text_of(report_of(5'000'000, false), {20'000'000}), "all points in view shown");
    // Neither loading nor complete: the points that time and memory allow.
    FrameReport stopped = report_of(5'000'000, false);
    stopped.full_resolution = false;
    EXPECT_EQ(text_of(stopped, {20'000'000}), "5.0 of 20 M points");
    EXPECT_EQ(overlay_text(report_of(0, false, 0), {}, nullptr), "");
}

TEST(Overlay, SaysThatThePictureBecomesSmoothAndOfHowManyFramesItIs)
{
    FrameReport report = report_of(20'000'000, false);
    report.refining = report.smoothing = true;
    report.full_resolution = true;
    report.frames_averaged = 5;
    report.smooth_frames = 10;
    EXPECT_EQ(text_of(report, {20'000'000}), "all points shown, smoothing: 5 of 10…");
    EXPECT_EQ(text_of(report, {30'000'000}), "all points in view shown, smoothing: 5 of 10…");
    report.clouds[0].points_hidden = 10'000'000;
    EXPECT_EQ(text_of(report, {30'000'000}),
              "all points shown, smoothing: 5 of 10…; 10,000,000 hidden by the conditions");
    report.clouds[0].points_hidden = 0;
    report.refining = report.smoothing = false;
    report.frames_averaged = 10;
    EXPECT_EQ(text_of(report, {20'000'000}), "all points shown");
    EXPECT_NE(text_of(report, {20'000'000}, true).indexOf("; mean of 10 frames"), -1);
}

TEST(Overlay, SaysHowManyPointsConditionsHide)
{
    FrameReport report = report_of(15'000'000, false);
    report.clouds[0].points_hidden = 5'000'000;
    EXPECT_EQ(text_of(report, {20'000'000}), "all points shown; 5,000,000 hidden by the conditions");
    EXPECT_EQ(text_of(report, {30'000'000}), "all points in view shown; 5,000,000 hidden by the conditions");
    report.full_resolution = false;
    report.refining = true;
    EXPECT_EQ(text_of(report, {20'000'000}), "15 of 20 M points, loading…; 5,000,000 hidden by the conditions");
}

TEST(Overlay, SaysWhatAClipBoxHidesAndHowMuchIsSelected)
{
    const auto text = [](std::vector<OverlayCloud> clouds) {
        return overlay_text(report_of(1'000, false), clouds, nullptr);
    };
    OverlayCloud cloud{"cloud", 20'000'000};
    cloud.clipped = true;
    EXPECT_EQ(text({cloud}), "all points in view shown<br>clip box on");
    cloud.hidden_by_clip = Clipped{12'345'678, false};
    EXPECT_EQ(text({cloud}), "all points in view shown<br>clip box on: about 12 M points hidden");
    cloud.hidden_by_clip = Clipped{12'345.6, false};
    EXPECT_EQ(text({cloud}), "all points in view shown<br>clip box on: about 12,000 points hidden");
    cloud.hidden_by_clip = Clipped{12'345, true};
    cloud.selected = 1;
    EXPECT_EQ(text({cloud}), "all points in view shown<br>clip box on: 12,345 points hidden<br>1 point selected");
    OverlayCloud other{"other", 1'000};
    other.selected = 999;
    EXPECT_EQ(text({cloud, other}),
              "all points in view shown<br>clip box on: 12,345 points hidden<br>1,000 points selected");
}

TEST(Overlay, LayersShareOneLine)
{
    EXPECT_EQ(text_of(report_of(3'000'000, true, 2), {2'000'000, 4'000'000}), "3.0 of 6.0 M points, loading…");
}

TEST(Overlay, DetailsAreForThoseWhoAsk)
{
    FrameReport report = report_of(3'000'000, true, 2);
    report.screen_error_px = 2.5;
    report.clouds[0].points_drawn = 1'000'000;
    report.clouds[1].points_drawn = 2'000'000;
    const QString brief_text = text_of(report, {2'000'000, 4'000'000});
    for (const char* detail : {"ms", "screen error", "MB", "hits", "samples", "cloud 1"})
        EXPECT_FALSE(brief_text.contains(detail)) << detail;
    EXPECT_EQ(text_of(report, {2'000'000, 4'000'000}, true),
              "3.0 of 6.0 M points, loading…<br>20.8 ms per frame; screen error 2.5 px (target 1.4); 4 samples per "
              "pixel<br>cloud 0: 1.0 of 2.0 M points<br>cloud 1: 2.0 of 4.0 M points<br>video memory: 36 of 512 MB, 81 "
              "% hits");
}

TEST(Overlay, SentencesAreSaidOnceAndAreNoMarkup)
{
    FrameReport report = report_of(1'000, false, 2);
    report.error = "cannot read <x>";
    for (CloudReport& cloud : report.clouds) {
        cloud.error = "cannot read <x>";
        cloud.notice = "no normals";
    }
    const QString text = text_of(report, {600, 400});
    EXPECT_EQ(text, "all points shown<br>cannot read &lt;x&gt;<br>no normals");
    EXPECT_FALSE(text.contains("<t"));
}

}  // namespace
