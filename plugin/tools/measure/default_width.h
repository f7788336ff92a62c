// The width of a profile for which nothing is typed. Any thread.
#pragma once

#include <vector>

namespace pcm::host {

// What is known when the line is drawn.
struct ProfileLine {
    double length = 0;             // length of the line, source units
    double pixel = 0;              // size of the picture's pixel at the line, source units; 0: not known
    std::vector<double> spacings;  // spacings of the points where it was clicked, source units
};

// Ten times the median of the spacings, so that walls and ground are dense lines, but at least three pixels, which are
// seen; no wider than a tenth of the line, and no narrower than two spacings, in which a profile would be empty; as a
// round number (system/round_number.h). Where no spacing is known a fiftieth of the line; 0 where nothing is known.
double default_width(const ProfileLine& line);

}  // namespace pcm::host
