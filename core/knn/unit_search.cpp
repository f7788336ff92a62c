#include "pcm/knn/unit_search.h"

#include <algorithm>

namespace pcm {
namespace {

double squared_of(const SearchPositions& p, std::uint32_t a, std::uint32_t b)
{
    double d[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int64_t steps =
            p.is_wide() ? p.wide[axis][b] - p.wide[axis][a] : std::int64_t(p.narrow[axis][b]) - p.narrow[axis][a];
        d[axis] = static_cast<double>(steps) * p.scale[axis];
    }
    return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
}

class ComparingSearch final : public UnitSearch {
public:
    explicit ComparingSearch(SearchPositions positions) : positions_(std::move(positions)) {}
    void search(const std::vector<std::uint32_t>* queries, const UnitSearchOptions& options,
                const std::function<void(const FoundNeighbours&)>& found) const override
    {
        const std::size_t n = positions_.size();
        const double limit = options.max_distance * options.max_distance;
        for (std::size_t q = 0; q < (queries ? queries->size() : n); ++q) {
            const std::uint32_t point = queries ? (*queries)[q] : static_cast<std::uint32_t>(q);
            std::vector<std::pair<double, std::uint32_t>> all;
            for (std::uint32_t i = 0; i < n; ++i) {
                const double square = i == point ? limit + 1 : squared_of(positions_, point, i);
                if (i != point && square <= limit) all.emplace_back(square, i);
            }
            const std::size_t k = std::min(options.neighbours, all.size());
            std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(k), all.end());
            std::vector<std::uint32_t> neighbours;
            std::vector<double> squares;
            for (std::size_t j = 0; j < k; ++j) {
                squares.push_back(all[j].first);
                neighbours.push_back(all[j].second);
            }
            const auto count = static_cast<std::uint32_t>(k);
            FoundNeighbours one{&point, 1, k, neighbours.data(), squares.data(), &count};
            found(one);
        }
    }

private:
    SearchPositions positions_;
};

}  // namespace

std::unique_ptr<UnitSearch> make_unit_search(SearchPositions positions)
{
    return std::make_unique<ComparingSearch>(std::move(positions));
}

std::vector<std::uint32_t> nearest_of(const SearchPositions& positions, const std::vector<std::uint32_t>& points,
                                      const std::vector<std::uint32_t>& among)
{
    std::vector<std::uint32_t> nearest;
    for (const std::uint32_t point : points)
        nearest.push_back(*std::min_element(among.begin(), among.end(), [&](std::uint32_t a, std::uint32_t b) {
            return squared_of(positions, point, a) < squared_of(positions, point, b);
        }));
    return nearest;
}

}  // namespace pcm
