// Round numbers for the axes of a plot.
#pragma once

#include <QString>

#include <vector>

namespace pcm::host {

struct Ticks {
    double step = 1;             // 1, 2 or 5 times a power of ten
    std::vector<double> values;  // multiples of it, ascending
    // With as many decimals as the step has.
    QString text(double value) const;
};

// At most `most` (2 or more) of them in [from, to]; none for numbers that are not finite or an empty range.
Ticks round_ticks(double from, double to, int most);

// The part of a plane that a plot shows, and where: x to the right, y upwards, pixels of Qt.
struct PlotFrame {
    double left = 0, right = 1, bottom = 0, top = 1;  // values
    int x = 0, y = 0, width = 1, height = 1;          // pixels of the area, from its upper left corner

    double pixel_x(double value) const { return x + (value - left) / (right - left) * width; }
    double pixel_y(double value) const { return y + (top - value) / (top - bottom) * height; }
    double value_x(double pixel) const { return left + (pixel - x) / width * (right - left); }
    double value_y(double pixel) const { return top - (pixel - y) / height * (top - bottom); }

    // The values of both pixels stay under them; factors above 1 show less.
    void zoom(double pixel_at_x, double pixel_at_y, double factor_x, double factor_y);
    // By pixels, to the right and downwards.
    void move(double dx, double dy);
    // Shows all of the given ranges with a border; with `equal`, a unit is as long on both axes.
    void fit(double x0, double x1, double y0, double y1, bool equal);
    void make_equal();  // about the centre; nothing that was shown is lost
};

}  // namespace pcm::host
