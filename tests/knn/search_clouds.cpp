#include "tests/knn/search_clouds.h"

#include <algorithm>
#include <set>
#include <sstream>

namespace pcm::search_clouds {
namespace {

Vec3i position_of(const SearchPositions& p, std::uint32_t i)
{
    Vec3i at;
    for (std::size_t axis = 0; axis < 3; ++axis) at[axis] = p.is_wide() ? p.wide[axis][i] : p.narrow[axis][i];
    return at;
}

// The square and the position of the nearest k, those at equal distance by position.
std::vector<std::pair<double, Vec3i>> nearest_in_order(const SearchPositions& p, std::uint32_t query,
                                                       const UnitSearchOptions& options)
{
    std::vector<std::pair<double, Vec3i>> nearest;
    for (std::uint32_t i = 0; i < p.size(); ++i) {
        const double square = squared_of(p, query, i);
        if (i != query && square <= options.max_distance * options.max_distance)
            nearest.emplace_back(square, position_of(p, i));
    }
    const std::size_t k = std::min(options.neighbours, nearest.size());
    std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(k), nearest.end());
    nearest.resize(k);
    return nearest;
}

std::string mistake_of(const SearchPositions& p, const UnitSearchOptions& options, const FoundNeighbours& found,
                       std::size_t i)
{
    const std::uint32_t query = found.points[i];
    const auto expected = nearest_in_order(p, query, options);
    std::ostringstream text;
    text.precision(17);
    text << "point " << query << ": ";
    if (found.counts[i] != expected.size()) {
        text << found.counts[i] << " neighbours instead of " << expected.size();
        return text.str();
    }
    std::set<std::uint32_t> seen{query};
    for (std::size_t j = 0; j < expected.size(); ++j) {
        const std::uint32_t neighbour = found.neighbours[i * found.stride + j];
        const double square = found.squared[i * found.stride + j];
        if (neighbour >= p.size() || !seen.insert(neighbour).second) {
            text << "neighbour " << j << " is " << neighbour << ", itself or a second time";
            return text.str();
        }
        if (square != squared_of(p, query, neighbour) || square != expected[j].first ||
            position_of(p, neighbour) != expected[j].second) {
            text << "neighbour " << j << ", " << neighbour << ": " << square << ", really "
                 << squared_of(p, query, neighbour) << ", instead of " << expected[j].first
                 << (square == expected[j].first ? " at another place" : "");
            return text.str();
        }
    }
    return {};
}

}  // namespace

std::vector<double> all_pairs(const SearchPositions& p, std::uint32_t query, const UnitSearchOptions& options)
{
    std::vector<double> squares;
    for (const auto& [square, position] : nearest_in_order(p, query, options)) squares.push_back(square);
    return squares;
}

Comparison compare(const SearchPositions& p, const UnitSearchOptions& options,
                   const std::vector<std::uint32_t>* queries, std::size_t stride)
{
    return compare(*make_unit_search(p), p, options, queries, stride);
}

Comparison compare(const UnitSearch& search, const SearchPositions& p, const UnitSearchOptions& options,
                   const std::vector<std::uint32_t>* queries, std::size_t stride)
{
    Comparison result;
    std::vector<bool> expected(p.size(), !queries);
    if (queries)
        for (const std::uint32_t query : *queries) expected[query] = true;
    search.search(queries, options, [&](const FoundNeighbours& found) {
        for (std::size_t i = 0; i < found.size; ++i) {
            std::string mistake;
            if (!expected[found.points[i]])
                mistake = "point " + std::to_string(found.points[i]) + " is not a query, or comes a second time";
            else if (found.points[i] % stride == 0)
                mistake = mistake_of(p, options, found, i);
            expected[found.points[i]] = false;
            if (result.first_mistake.empty()) result.first_mistake = mistake;
            ++result.queries;
        }
    });
    const auto missing = std::find(expected.begin(), expected.end(), true);
    if (result.first_mistake.empty() && missing != expected.end())
        result.first_mistake = "point " + std::to_string(missing - expected.begin()) + " does not come";
    return result;
}

}  // namespace pcm::search_clouds
