// Icons of the tools, painted at run time.
#pragma once

#include <QIcon>

namespace pcm::host {

// An eye above four arrows.
QIcon first_person_icon();
// A point in a cross, between others.
QIcon pick_point_icon();
// A box; some of its points are grey.
QIcon clip_box_icon();
// A dashed rectangle around coloured points.
QIcon select_points_icon();
// Two point clouds, joined by lines.
QIcon align_icon();
// A cylinder of lines around coloured points.
QIcon fit_icon();
// A line between two crosses above a ruler.
QIcon measure_icon();

}  // namespace pcm::host
