// What the colours of a cloud mean, in words and numbers. No OpenGL here.
#pragma once

#include "pcm/gl/draw/renderer.h"

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace pcm {

// A ramp with values, or classes with names.
struct Legend {
    struct Row {
        unsigned number = 0;  // of the class
        std::array<std::uint8_t, 3> colour{};
        std::string name;     // with the number: "2  ground"
        bool hidden = false;  // its points are not shown
    };
    std::string title;              // with the unit: "Height (m)"
    std::string low, middle, high;  // values at the ramp's beginning, middle and end; empty for classes
    ColourRamp ramp = ColourRamp::viridis;
    ValueRange range;       // of the ramp, where it has values
    std::vector<Row> rows;  // classes that occur, ascending

    // Title, then values or classes.
    std::vector<std::string> lines() const;
};

// Of a cloud as it was drawn; nothing for colours without a scale. `height_unit`: see io/crs/height_unit.h. `hidden`:
// classes that the user hides; they are listed too.
std::optional<Legend> legend_of(const CloudReport& report, const std::string& height_unit,
                                const std::set<unsigned>& hidden = {});

// With as many digits as distinguish values of a range of this width.
std::string value_text(double value, double width);

}  // namespace pcm
