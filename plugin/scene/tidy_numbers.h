// Numbers with no more digits than the clouds have: what tools compute has sixteen, which say nothing. Any thread.
#pragma once

#include "plugin/scene/scene_state.h"

#include <QString>

namespace pcm::host {

// The decimal number next to the value, with as many decimals as the step needs (2 for 0.01, 3 for 0.025). The value
// itself where the step is not positive and finite, or finer than its digits.
double decimal(double value, double step);
// As text, without zeros at the end.
QString decimal_text(double value, double step);
// A coordinate of a point on a grid, without the noise that the grid's steps have in double: 636798.2 of 63679820 *
// 0.01.
QString on_grid_text(double value, double step);

// The box with a centre and sizes of few digits: sizes to `step`, the centre to a tenth of it. With `contains` its
// sizes are rounded up, so that what an upright box contains stays inside.
ClipBox tidied(const ClipBox& box, double step, bool contains = false);

}  // namespace pcm::host
