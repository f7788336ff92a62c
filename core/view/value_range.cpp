#include "pcm/view/value_range.h"

#include "pcm/system/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace pcm {
namespace {

// Place of the median on the ramp.
constexpr double least_place = 0.4, most_place = 0.7;

std::optional<double> number_of(const char* begin, const char* end)
{
    if (begin != end && *begin == '+') ++begin;
    double value = 0;
    const auto result = std::from_chars(begin, end, value);
    if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value)) return std::nullopt;
    return value;
}

}  // namespace

double ValueRange::place_of(double value) const
{
    const double t = std::clamp((value - low) / (high - low), 0.0, 1.0);
    return exponent == 1 ? t : std::pow(t, exponent);
}

double ValueRange::value_at(double place) const
{
    return low + (high - low) * (exponent == 1 ? place : std::pow(place, 1 / exponent));
}

ValueRange parse_value_range(const std::string& text)
{
    const auto colon = text.find(':');
    const char *begin = text.data(), *end = begin + text.size();
    const auto low = colon == std::string::npos ? std::nullopt : number_of(begin, begin + colon);
    const auto high = colon == std::string::npos ? std::nullopt : number_of(begin + colon + 1, end);
    if (!low || !high || !(*low < *high))
        throw Error(ErrorCode::invalid_argument, {}, "'" + text + "' is not a range of values",
                    "write two numbers, the smaller one first, as in 0:255 or -2.5:10");
    return {*low, *high, 1};
}

ValueSummary summary_of(std::vector<double>& values)
{
    values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
                 values.end());
    ValueSummary summary;
    summary.values = values.size();
    if (values.empty()) return summary;
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    summary.least = *least;
    summary.most = *most;
    const auto ranked = [&](double rank) {
        const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
        std::nth_element(values.begin(), place, values.end());
        return *place;
    };
    // Ranks are rounded outwards: with few values, these are the extremes.
    const auto last = static_cast<double>(values.size() - 1);
    summary.low = ranked(std::floor(0.01 * last));
    summary.high = ranked(std::ceil(0.99 * last));
    summary.median = ranked(std::floor(0.5 * last));
    return summary;
}

ValueRange linear_range(const ValueSummary& summary)
{
    if (summary.is_constant()) {
        const double half = std::max(0.5, 1e-9 * std::fabs(summary.least));
        return {summary.least - half, summary.least + half, 1};
    }
    if (summary.low < summary.high) return {summary.low, summary.high, 1};
    return {summary.least, summary.most, 1};
}

ValueRange balanced_range(const ValueSummary& summary)
{
    ValueRange range = linear_range(summary);
    const double place = (summary.median - range.low) / (range.high - range.low);
    if (!(place > 0 && place < 1)) return range;
    const double wanted = std::clamp(place, least_place, most_place);
    // No more than this: values near the low end would all look the same.
    if (wanted != place) range.exponent = std::clamp(std::log(wanted) / std::log(place), 0.4, 2.5);
    return range;
}

std::vector<SampledChunk> coarsest_chunks(const Tree& tree)
{
    // Chunks above which there is none with points.
    std::vector<NodeId> first;
    const NodeTable& nodes = tree.nodes();
    std::vector<NodeId> open;
    if (!nodes.empty()) open.push_back(0);
    while (!open.empty()) {
        const NodeId id = open.back();
        open.pop_back();
        if (nodes[id].points > 0) {
            first.push_back(id);
            continue;
        }
        for (const NodeId child : nodes[id].children)
            if (child != no_node) open.push_back(child);
    }
    std::sort(first.begin(), first.end(), [&](NodeId a, NodeId b) {
        const std::uint64_t of_a = nodes[a].subtree_points, of_b = nodes[b].subtree_points;
        return of_a != of_b ? of_a > of_b : a < b;
    });
    if (first.size() > most_sampled_chunks) first.resize(most_sampled_chunks);
    std::size_t level = ~std::size_t(0);
    for (const NodeId id : first)  // a leaf holds all points that there are
        if (!nodes[id].is_leaf()) level = std::min(level, nodes[id].first_level + nodes[id].level_points.size() - 1);
    std::vector<SampledChunk> chunks;
    for (const NodeId id : first)
        if (const std::uint32_t points = nodes[id].points_to_level(level)) chunks.push_back({id, points});
    return chunks;
}

std::optional<AttributePlace> place_of(const Schema& schema, const std::string& name)
{
    if (const auto whole = schema.find(name)) {
        if (schema[*whole].components != 1) return std::nullopt;
        return AttributePlace{*whole, 0};
    }
    const auto bracket = name.rfind('[');
    if (bracket == std::string::npos || name.back() != ']') return std::nullopt;
    std::uint32_t component = 0;
    const char *begin = name.data() + bracket + 1, *end = name.data() + name.size() - 1;
    const auto result = std::from_chars(begin, end, component);
    const auto attribute = schema.find(name.substr(0, bracket));
    if (result.ec != std::errc() || result.ptr != end || !attribute || component >= schema[*attribute].components)
        return std::nullopt;
    return AttributePlace{*attribute, component};
}

std::vector<std::string> component_names(const Schema& schema)
{
    std::vector<std::string> names;
    for (const Attribute& attribute : schema)
        for (std::uint32_t c = 0; c < attribute.components; ++c)
            names.push_back(attribute.components == 1 ? attribute.name
                                                      : attribute.name + "[" + std::to_string(c) + "]");
    return names;
}

}  // namespace pcm
