// Plots of profiles: round numbers at the axes, what is where, zooming.
#include "plugin/tools/measure/profile_plot.h"

#include <QCoreApplication>
#include <QMouseEvent>

#include <gtest/gtest.h>

#include <cmath>

using namespace pcm::host;

namespace {

TEST(RoundTicks, StepsAreRoundAndNotTooMany)
{
    for (const double size : {1e-9, 3e-4, 0.07, 1.0, 2.5, 99.0, 4.2e5, 8e11})
        for (const int most : {2, 5, 9, 20}) {
            const Ticks ticks = round_ticks(0.1 * size, 1.1 * size, most);
            const double digit = ticks.step / std::pow(10, std::floor(std::log10(ticks.step) + 1e-9));
            EXPECT_TRUE(std::abs(digit - 1) < 1e-6 || std::abs(digit - 2) < 1e-6 || std::abs(digit - 5) < 1e-6)
                << ticks.step;
            EXPECT_LE(ticks.values.size(), static_cast<std::size_t>(most));
            EXPECT_GE(ticks.step * most, size * (1 - 1e-9));
            EXPECT_LE(ticks.step * most, size * 2.5 * (1 + 1e-9));
            for (const double value : ticks.values) {
                EXPECT_GE(value, 0.1 * size - 1e-9 * size);
                EXPECT_LE(value, 1.1 * size + 1e-9 * size);
            }
        }
}

TEST(RoundTicks, TextsHaveTheDigitsOfTheStep)
{
    const Ticks fine = round_ticks(4800000.0, 4800000.01, 5);
    ASSERT_FALSE(fine.values.empty());
    EXPECT_EQ(fine.text(fine.values[1]), "4800000.002");
    EXPECT_EQ(round_ticks(-1, 1, 4).text(0), "0");
    EXPECT_EQ(round_ticks(-1, 1, 4).text(-0.5), "-0.5");
    EXPECT_EQ(round_ticks(0, 5000, 5).text(2000), "2000");
}

TEST(RoundTicks, NothingForRangesThatAreNone)
{
    EXPECT_TRUE(round_ticks(1, 1, 5).values.empty());
    EXPECT_TRUE(round_ticks(2, 1, 5).values.empty());
    EXPECT_TRUE(round_ticks(0, NAN, 5).values.empty());
    EXPECT_TRUE(round_ticks(0, INFINITY, 5).values.empty());
}

TEST(PlotFrame, PixelsAndValuesAreInverse)
{
    PlotFrame frame{100, 300, 4800000, 4800050, 40, 10, 800, 400};
    EXPECT_DOUBLE_EQ(frame.pixel_x(100), 40);
    EXPECT_DOUBLE_EQ(frame.pixel_y(4800050), 10) << "heights grow upwards";
    EXPECT_NEAR(frame.value_x(frame.pixel_x(123.456)), 123.456, 1e-12 * 300);
    EXPECT_NEAR(frame.value_y(frame.pixel_y(4800001.234)), 4800001.234, 1e-8);
}

TEST(PlotFrame, TheValueUnderTheCursorStaysWhenZooming)
{
    PlotFrame frame{0, 10, 0, 5, 0, 0, 1000, 500};
    const double x = frame.value_x(300), y = frame.value_y(100);
    frame.zoom(300, 100, 2, 4);
    EXPECT_NEAR(frame.value_x(300), x, 1e-12);
    EXPECT_NEAR(frame.value_y(100), y, 1e-12);
    EXPECT_NEAR(frame.right - frame.left, 5, 1e-12);
    EXPECT_NEAR(frame.top - frame.bottom, 1.25, 1e-12);
    for (int i = 0; i < 10000; ++i) frame.zoom(300, 100, 2, 2);
    EXPECT_GT(frame.right, frame.left);
    EXPECT_GT(frame.top, frame.bottom);
    for (int i = 0; i < 10000; ++i) frame.zoom(300, 100, 0.5, 0.5);
    EXPECT_TRUE(std::isfinite(frame.right - frame.left));
}

TEST(PlotFrame, EqualScalesLoseNothing)
{
    PlotFrame frame;
    frame.width = 900;
    frame.height = 300;
    frame.fit(0, 100, 50, 60, true);
    EXPECT_NEAR((frame.right - frame.left) / 900, (frame.top - frame.bottom) / 300, 1e-12);
    EXPECT_LT(frame.left, 0);
    EXPECT_GT(frame.right, 100);
    EXPECT_LT(frame.bottom, 50);
    EXPECT_GT(frame.top, 60);
    frame.fit(5, 5, 4800000, 4800000, false);  // a single point
    EXPECT_GT(frame.right, frame.left);
    EXPECT_GT(frame.top, frame.bottom);
}

class ProfilePlotTest : public testing::Test {
protected:
    void SetUp() override
    {
        plot.resize(900, 420);
        plot.show_points({{0.37, 100.3, qRgb(255, 0, 0)}, {9.71, 103.9, qRgb(0, 0, 255)}}, "Profile 1", "m");
    }
    QRgb colour_at(double station, double height)
    {
        const QImage picture = plot.grab().toImage();
        return picture.pixel(static_cast<int>(plot.frame().pixel_x(station)),
                             static_cast<int>(plot.frame().pixel_y(height)));
    }
    void send(QEvent::Type type, const QPointF& at, Qt::MouseButton button, Qt::KeyboardModifiers modifiers = {})
    {
        QMouseEvent event(type, at, button, type == QEvent::MouseButtonRelease ? Qt::NoButton : button, modifiers);
        QCoreApplication::sendEvent(&plot, &event);
    }

    ProfilePlot plot;
};

TEST_F(ProfilePlotTest, PointsAreWhereTheAxesSay)
{
    EXPECT_EQ(colour_at(0.37, 100.3), qRgb(255, 0, 0));
    EXPECT_EQ(colour_at(9.71, 103.9), qRgb(0, 0, 255));
    EXPECT_EQ(colour_at(5.3, 103.37), qRgb(255, 255, 255));
    plot.set_equal_scale(false);
    EXPECT_EQ(colour_at(9.71, 103.9), qRgb(0, 0, 255));
    EXPECT_GT(plot.frame().pixel_y(100) - plot.frame().pixel_y(104), 200) << "the heights fill the plot";
}

TEST_F(ProfilePlotTest, DraggingMovesAndWithShiftMeasures)
{
    const PlotFrame before = plot.frame();
    send(QEvent::MouseButtonPress, {300, 200}, Qt::LeftButton);
    send(QEvent::MouseMove, {400, 180}, Qt::LeftButton);
    send(QEvent::MouseButtonRelease, {400, 180}, Qt::LeftButton);
    EXPECT_NEAR(plot.frame().value_x(400), before.value_x(300), 1e-9);
    EXPECT_NEAR(plot.frame().value_y(180), before.value_y(200), 1e-9);
    EXPECT_FALSE(plot.span().has_value());
    const QPointF from(plot.frame().pixel_x(0), plot.frame().pixel_y(100));
    const QPointF to(plot.frame().pixel_x(3), plot.frame().pixel_y(104));
    send(QEvent::MouseButtonPress, from, Qt::LeftButton, Qt::ShiftModifier);
    send(QEvent::MouseMove, to, Qt::LeftButton, Qt::ShiftModifier);
    send(QEvent::MouseButtonRelease, to, Qt::LeftButton, Qt::ShiftModifier);
    ASSERT_TRUE(plot.span().has_value());
    EXPECT_NEAR(plot.span()->station1 - plot.span()->station0, 3, 1e-9);
    EXPECT_NEAR(plot.span()->height1 - plot.span()->height0, 4, 1e-9);
    EXPECT_TRUE(plot.text_of_span().startsWith("5.")) << plot.text_of_span().toStdString();
    send(QEvent::MouseButtonDblClick, from, Qt::LeftButton);
    EXPECT_NEAR(plot.frame().left, before.left, 1e-9);
}

}  // namespace
