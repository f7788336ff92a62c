// The range of values that a colour ramp shows, found in a sample of a cloud. No OpenGL here.
//
// Pure functions: the result depends on the tree and the values alone, never on a view or on the order of loading.
#pragma once

#include "pcm/cloud/attribute.h"
#include "pcm/tree/tree.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm {

// Values at the ends of a ramp, as users see them: raw * scale + offset. A value v is at the place
// ((v - low) / (high - low)) ^ exponent of the ramp, clamped to 0..1.
struct ValueRange {
    double low = 0;
    double high = 1;
    double exponent = 1;

    double place_of(double value) const;
    double value_at(double place) const;  // the inverse, for places from 0 to 1
};
inline bool operator==(const ValueRange& a, const ValueRange& b)
{
    return a.low == b.low && a.high == b.high && a.exponent == b.exponent;
}
inline bool operator!=(const ValueRange& a, const ValueRange& b) { return !(a == b); }

// "LOW:HIGH", two finite numbers, the smaller one first. Throws Error(invalid_argument).
ValueRange parse_value_range(const std::string& text);

// Statistics of a sample of one quantity.
struct ValueSummary {
    std::uint64_t values = 0;    // finite ones
    double least = 0, most = 0;  // range of these
    double low = 0, high = 0;    // their 1st and 99th percentile
    double median = 0;

    bool is_constant() const { return !(least < most); }  // also without any finite value
};
// Values that are not finite are left out. Changes the order of the values.
ValueSummary summary_of(std::vector<double>& values);

// Both leave extreme values outside of the range: they have the colours of the ramp's ends. From the 1st to the 99th
// percentile; where these are equal, all values. Without two different values the range has a width of 1 about the one.
ValueRange linear_range(const ValueSummary& summary);
// The same, bent so that the median is not below 0.4 or above 0.7 of the ramp: for intensities, most of
// which are often much lower than the largest percent.
ValueRange balanced_range(const ValueSummary& summary);

// Where a sample of a cloud lies: the first `points` points of some chunks. An even sample of the whole cloud: all
// points up to one level, of all parts of the tree. In a tree with very many parts, the parts with most points.
struct SampledChunk {
    NodeId node = no_node;
    std::uint32_t points = 0;
};
std::vector<SampledChunk> coarsest_chunks(const Tree& tree);
inline constexpr std::size_t most_sampled_chunks = 64;

// A component of an attribute, by the name that users write: "intensity", or "rgb[0]" where there are several.
struct AttributePlace {
    std::size_t attribute = 0;  // in the schema
    std::uint32_t component = 0;
};
inline bool operator==(const AttributePlace& a, const AttributePlace& b)
{
    return a.attribute == b.attribute && a.component == b.component;
}
// Nothing when the schema has no such component; an attribute of several components needs a number.
std::optional<AttributePlace> place_of(const Schema& schema, const std::string& name);
// All names that place_of() takes, in the schema's order.
std::vector<std::string> component_names(const Schema& schema);

}  // namespace pcm
