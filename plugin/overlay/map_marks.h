// What a map has in addition to its content: a scale bar, an arrow to north, and a grid of coordinates in plan view. No
// OpenGL here. Cameras are in source coordinates; everything is computed in double, relative to the eye.
#pragma once

#include "pcm/cloud/geometry.h"
#include "pcm/view/camera.h"

#include <QImage>
#include <QPointF>
#include <QString>

#include <array>
#include <optional>
#include <utility>
#include <vector>

namespace pcm::host {

// The largest of 1, 2 and 5 times a power of ten that is no larger. `most` is positive and finite.
double round_length(double most);

// A multiple of a round step, without an exponent and with the digits that the step needs.
QString step_text(double value, double step);

struct ScaleBar {
    double length = 0;  // source units, round
    double pixels = 0;
};
// A bar of at most this many pixels at a depth, in eye units: exact there, and anywhere in orthographic views. Absent
// for a camera that can show nothing.
std::optional<ScaleBar> scale_bar(const Camera& camera, double depth, double most_pixels);

// Where +y of source coordinates points on the screen (x to the right, y up); its length is 1 where that is across the
// view, and less where it is seen obliquely. Absent where it is seen nearly along its direction.
std::optional<std::array<double, 2>> north(const Camera& camera);

// Lines of constant x and y.
struct PlanGrid {
    double step = 0;  // source units, round
    std::vector<std::array<Vec3d, 2>> lines;
    std::vector<std::pair<QString, QPointF>>
        labels;  // and where each line meets the border; pixels from the lower left
};
// Lines about this many pixels apart, through the place of the view's axis at a depth in eye units. Absent for views
// that are not orthographic or look down more than 2 degrees from the vertical.
std::optional<PlanGrid> plan_grid(const Camera& camera, double depth, double least_pixels);

// Images for blend_image(), for a screen with `ratio` pixels to one of Qt's.
QImage scale_bar_image(const ScaleBar& bar, const QString& unit, double ratio);
QImage north_image(const std::array<double, 2>& direction, double ratio);

}  // namespace pcm::host
