// What the errors of a fitted shape contain of the differences between the stations that a cloud was scanned from.
#pragma once

#include <cstdint>
#include <string>

namespace pcm {

// Which numbers say from which station a point was measured.
enum class StationSource : std::uint8_t {
    none,       // nothing does
    attribute,  // an attribute: `scan` of PTX and E57, `point_source_id` of LAS
    time_gaps,  // gaps between the GPS times of the points
};

struct StationFacts {
    StationSource source = StationSource::none;
    std::uint32_t stations = 0;  // number of stations that see the shape; 0: unknown
    // How far stations are apart after their registration: standard deviation of a station's shift along one axis,
    // source units; as the points of several stations on the same surfaces show it. 0: they show none.
    double spread = 0;
    std::uint32_t freedom = 0;  // number of independent differences that show it; 0: no surface is seen from two
    // Share of the variance of the points' errors that lies along the rays of the scanner; 0: none shows. The shape is
    // without the bias that such errors cause, and its errors contain what may be left of it.
    double ray_share = 0;
    double registration = 0;  // as given, source units; 0: none was given
    // Standard deviation of a station's turn about one axis, radians, which belongs to contained(). 0: none is
    // contained.
    double turn = 0;

    // The larger one of both: what the errors contain. 0: they are those of the points' noise alone.
    double contained() const { return spread > registration ? spread : registration; }
};

const char* name_of(StationSource source);  // "attribute"

// Which errors the +- contains, as a sentence for people: "seen from 3 stations; stations differ by 0.0014 here: the +-
// contains the noise and this".
std::string station_text(const StationFacts& facts);
// The same of all shapes of a cloud: without how many stations see a shape.
std::string spread_text(const StationFacts& facts);

}  // namespace pcm
