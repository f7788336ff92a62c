#include "pcm/knn/flann_search.h"

#include "pcm/cloud/morton.h"
#include "pcm/knn/flann/flann_module.h"
#include "pcm/system/error.h"
#include "pcm/system/shared_module.h"

#include <algorithm>
#include <numeric>

namespace pcm {
namespace {

constexpr std::size_t queries_at_once = 1024;
constexpr const char* module_file = "libpcm_flann.so";

const SharedModule& module()
{
    static const SharedModule loaded = load_shared_module(module_file, flann_module_symbol, flann_module_version);
    return loaded;
}

class FlannSearch final : public UnitSearch {
public:
    explicit FlannSearch(SearchPositions positions) : positions_(std::move(positions))
    {
        const SharedModule& flann = module();
        if (!flann.functions)
            throw Error(ErrorCode::unsupported, {}, "the backend FLANN is not here: " + flann.missing,
                        "install libpcm_flann.so (built where libflann-dev is installed), or choose the backend own");
        functions_ = static_cast<const FlannFunctions*>(flann.functions);
        to_single_precision();
        char message[flann_message_bytes] = "out of memory";
        index_ = {functions_->make(xyz_.data(), positions_.size(), message), functions_->free};
        if (!index_) throw Error(ErrorCode::invalid_argument, {}, std::string("FLANN: ") + message);
    }

    void search(const std::vector<std::uint32_t>* queries, const UnitSearchOptions& options,
                const std::function<void(const FoundNeighbours&)>& found) const override
    {
        std::vector<std::uint32_t> points = order_;
        if (queries) {
            std::vector<bool> wanted(positions_.size());
            for (const std::uint32_t query : *queries) wanted[query] = true;
            points.erase(
                std::remove_if(points.begin(), points.end(), [&](std::uint32_t point) { return !wanted[point]; }),
                points.end());
        }
        for (std::size_t first = 0; first < points.size(); first += queries_at_once)
            search_some(points.data() + first, std::min(queries_at_once, points.size() - first), options, found);
    }

private:
    void to_single_precision()
    {
        const std::size_t n = positions_.size();
        std::vector<Vec3d> offsets(n);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto take = [&](const auto& column) {
                const auto [low, high] = std::minmax_element(column.begin(), column.end());
                const std::int64_t middle = *low + (std::int64_t(*high) - *low) / 2;
                for (std::size_t i = 0; i < n; ++i)
                    offsets[i][axis] = static_cast<double>(column[i] - middle) * positions_.scale[axis];
            };
            positions_.is_wide() ? take(positions_.wide[axis]) : take(positions_.narrow[axis]);
        }
        for (const Vec3d& offset : offsets)
            for (const double d : offset) xyz_.push_back(static_cast<float>(d));
        order_ = morton_order(offsets);
    }

    double square_of(std::uint32_t a, std::uint32_t b) const
    {
        double d[3];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::int64_t steps = positions_.is_wide()
                                           ? positions_.wide[axis][b] - positions_.wide[axis][a]
                                           : std::int64_t(positions_.narrow[axis][b]) - positions_.narrow[axis][a];
            d[axis] = static_cast<double>(steps) * positions_.scale[axis];
        }
        return (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
    }

    void search_some(const std::uint32_t* points, std::size_t size, const UnitSearchOptions& options,
                     const std::function<void(const FoundNeighbours&)>& found) const
    {
        const std::size_t k = std::min(options.neighbours, positions_.size() - 1), with_itself = k + 1;
        const double limit = options.max_distance * options.max_distance;
        std::vector<float> xyz(3 * size), distances(size * with_itself);
        for (std::size_t i = 0; i < size; ++i) std::copy_n(xyz_.data() + 3 * std::size_t(points[i]), 3, &xyz[3 * i]);
        std::vector<std::size_t> nearest(size * with_itself);
        char message[flann_message_bytes] = "";
        if (!functions_->search(index_.get(), xyz.data(), size, with_itself, nearest.data(), distances.data(), message))
            throw Error(ErrorCode::invalid_argument, {}, std::string("FLANN: ") + message);
        std::vector<std::uint32_t> ids(size * k), counts(size);
        std::vector<double> squares(size * k);
        std::vector<std::pair<double, std::uint32_t>> one;
        for (std::size_t i = 0; i < size; ++i) {
            one.clear();
            // Where many points lie at its place, the point itself may be missing among them: the last one is dropped.
            for (std::size_t j = 0; j < with_itself && one.size() < k; ++j) {
                const auto id = static_cast<std::uint32_t>(nearest[i * with_itself + j]);
                if (id != points[i]) one.emplace_back(square_of(points[i], id), id);
            }
            std::sort(one.begin(), one.end());
            for (const auto& [square, id] : one) {
                if (square > limit) break;
                ids[i * k + counts[i]] = id;
                squares[i * k + counts[i]++] = square;
            }
        }
        found({points, size, k, ids.data(), squares.data(), counts.data()});
    }

    SearchPositions positions_;
    std::vector<float> xyz_;            // offsets from the middle, source units
    std::vector<std::uint32_t> order_;  // order of the points, neighbours in space together
    const FlannFunctions* functions_ = nullptr;
    std::unique_ptr<void, void (*)(void*)> index_{nullptr, nullptr};
};

}  // namespace

std::unique_ptr<UnitSearch> make_flann_search(SearchPositions positions)
{
    return std::make_unique<FlannSearch>(std::move(positions));
}

bool has_flann() { return has_shared_module(module_file); }

std::string why_no_flann() { return module().functions ? std::string() : module().missing; }

}  // namespace pcm
