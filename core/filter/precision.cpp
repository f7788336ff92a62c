#include "pcm/filter/precision.h"

#include "pcm/filter/pilot.h"
#include "pcm/knn/point_search.h"
#include "pcm/threads/for_each_index.h"
#include "pcm/threads/thread_count.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace pcm {
namespace {

constexpr std::size_t checked_points = 1000, pilot_points = 300;
constexpr std::uint64_t check_seed = 20260101, pilot_seed = 20260102;

// The kinds of errors.
enum Kind : std::size_t { radii, normals, curvatures, mean_distances, kinds };
constexpr std::array<const char*, kinds> kind_names{"radii", "normals", "curvature", "mean distances"};

std::array<bool, kinds> kinds_of(const WantedValues& wanted)
{
    return {wanted.radius, wanted.normal, wanted.curvature, wanted.mean_distance};
}

// Exact values at single points, for one thread.
class SinglePoints {
public:
    SinglePoints(L2Cache& cache, BlockCache& blocks, const NeighbourAttributeOptions& options,
                 const AttributePlaces& places)
        : cache_(cache),
          schema_(cache.tree().info().schema),
          search_(cache, blocks, {}, options.max_distance),
          wanted_(options.wanted),
          known_(places.known_normal),
          k_(options.neighbours),
          radius_limit_(options.radius_limit)
    {
        if (known_) columns_.attributes.set(*known_);
        columns_.sizes = radius_limit_ > 0;
    }

    Vec3d position(const PointPlace& place)
    {
        chunk_ = cache_.get(place.node, columns_);
        return cache_.tree().info().grid.to_source(chunk_->positions->grid(place.index));
    }

    PointValues at(const PointPlace& place)
    {
        const Vec3d q = position(place);
        Vec3d known{};
        if (known_) known = known_normal_of(*chunk_->attributes[*known_], schema_[*known_], place.index);
        search_.run(q, k_ + 1, found_);
        for (std::vector<double>* values : {&x_, &y_, &z_, &squares_}) values->clear();
        for (const Neighbour& f : found_) {
            if ((f.node == place.node && f.index == place.index) || squares_.size() == k_) continue;
            x_.push_back(f.position[0] - q[0]);
            y_.push_back(f.position[1] - q[1]);
            z_.push_back(f.position[2] - q[2]);
            squares_.push_back(f.squared_distance);
        }
        PointValues values = values_of({x_.data(), y_.data(), z_.data(), squares_.data(), squares_.size()}, wanted_,
                                       known_ ? &known : nullptr);
        values.radius =
            std::min(values.radius, most_radius(*chunk_, place.index, cache_.tree().info().grid, radius_limit_));
        return values;
    }

private:
    L2Cache& cache_;
    const Schema& schema_;
    PointSearch search_;
    const WantedValues wanted_;
    const std::optional<std::size_t> known_;
    const std::size_t k_;
    const double radius_limit_;
    ColumnSet columns_;
    L2Cache::Handle chunk_;
    std::vector<Neighbour> found_;
    std::vector<double> x_, y_, z_, squares_;
};

double relative_percent(double value, double exact)
{
    if (value == exact) return 0;
    return exact > 0 ? 100 * std::fabs(value - exact) / exact : 100;
}

double degrees_between(const Vec3d& a, const Vec3d& b)
{
    const double s = length(a), t = length(b);
    if (s == 0 || t == 0) return s == t ? 0 : 90;
    const Vec3d across = cross(a, b);
    return std::atan2(length(across), std::fabs(dot(a, b))) * 180 / pi;
}

using Errors = std::array<double, kinds>;

Errors errors_of(const PointValues& value, const PointValues& exact)
{
    return {relative_percent(value.radius, exact.radius), degrees_between(value.normal, exact.normal),
            300 * std::fabs(value.curvature - exact.curvature),
            relative_percent(value.mean_distance, exact.mean_distance)};
}

// The value that the share `q` of the values does not exceed; reorders them.
double quantile(std::vector<double>& values, double q)
{
    const auto n = static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size())));
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(n, 1) - 1);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

// What the filter has written.
PointValues stored_values(L2Cache& cache, const AttributePlaces& places, const PointPlace& place)
{
    ColumnSet columns;
    columns.positions = false;
    for (const auto& k : {places.radius, places.normal, places.curvature, places.mean_distance})
        if (k) columns.attributes.set(*k);
    const L2Cache::Handle chunk = cache.get(place.node, columns);
    PointValues values;
    const auto value = [&](std::size_t k, std::uint32_t c = 0) { return chunk->attributes[k]->value(place.index, c); };
    if (places.radius) values.radius = value(*places.radius);
    if (places.normal)
        for (std::uint32_t a = 0; a < 3; ++a) values.normal[a] = value(*places.normal, a);
    if (places.curvature) values.curvature = value(*places.curvature);
    if (places.mean_distance) values.mean_distance = value(*places.mean_distance);
    return values;
}

// work(points, i) for all indices below `count`, by several threads with a SinglePoints each, runs of indices together.
template <class Work>
void with_points(std::size_t count, L2Cache& cache, const NeighbourAttributeOptions& options,
                 const AttributePlaces& places, const Work& work)
{
    BlockCache blocks(block_share(options.memory_bytes));
    const unsigned threads = thread_count(options.threads);
    const std::size_t runs = std::min<std::size_t>(count, std::size_t(4) * threads);
    for_each_index(
        runs, threads,
        [&](std::size_t run) {
            SinglePoints points(cache, blocks, options, places);
            for (std::size_t i = count * run / runs; i < count * (run + 1) / runs; ++i) work(points, blocks, i);
        },
        [](std::size_t) {});
}

// The largest error of 95 % of the points at each level, in the unit of an error target; the last is 0.
std::vector<double> errors_of_levels(L2Cache& cache, const NeighbourAttributeOptions& options,
                                     const AttributePlaces& places)
{
    const Tree& tree = cache.tree();
    const std::vector<PointPlace> sample = random_points(tree, pilot_points, pilot_seed);
    const std::size_t levels = tree.info().levels;
    std::vector<std::vector<Errors>> errors(levels, std::vector<Errors>(sample.size(), Errors{}));
    with_points(sample.size(), cache, options, places, [&](SinglePoints& points, BlockCache& blocks, std::size_t i) {
        const PointValues exact = points.at(sample[i]);
        const Vec3d q = points.position(sample[i]);
        std::vector<Neighbour> found;
        for (std::size_t l = 0; l + 1 < levels; ++l) {
            if (sample[i].index < tree.node(sample[i].node).points_to_level(l)) break;  // computed from here on
            PointSearch(cache, blocks, static_cast<std::uint16_t>(l)).run(q, 1, found);
            if (found.empty()) continue;
            errors[l][i] = errors_of(points.at({found[0].node, found[0].index}), exact);
        }
    });
    const auto wanted = kinds_of(options.wanted);
    std::vector<double> result;
    for (const std::vector<Errors>& of_level : errors) {
        double worst = 0;
        for (std::size_t kind = 0; kind < kinds && !of_level.empty(); ++kind) {
            if (!wanted[kind]) continue;
            std::vector<double> values;
            for (const Errors& e : of_level) values.push_back(e[kind]);
            worst = std::max(worst, quantile(values, 0.95) * (kind == normals ? 100 * pi / 180 : 1));
        }
        result.push_back(worst);
    }
    return result;
}

}  // namespace

std::vector<PointPlace> random_points(const Tree& tree, std::size_t count, std::uint64_t seed)
{
    std::vector<std::uint64_t> ends;
    for (const Node& node : tree.nodes()) ends.push_back((ends.empty() ? 0 : ends.back()) + node.points);
    std::vector<PointPlace> places;
    if (ends.empty() || ends.back() == 0) return places;
    std::mt19937_64 random(seed);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t n = random() % ends.back();
        const auto end = std::upper_bound(ends.begin(), ends.end(), n);
        const auto id = static_cast<NodeId>(end - ends.begin());
        places.push_back({id, static_cast<std::uint32_t>(n - (*end - tree.node(id).points))});
    }
    std::sort(places.begin(), places.end());
    return places;
}

std::pair<std::size_t, std::size_t> ranks_around_p95(std::size_t count)
{
    constexpr double share = 0.95, tail = 0.025;
    const auto n = static_cast<double>(count);
    std::pair<std::size_t, std::size_t> ranks{0, count > 0 ? count - 1 : 0};
    double at_most = 0;  // the probability that at most i of the values are below
    bool high = false;
    for (std::size_t i = 0; i < count && !high; ++i) {
        const auto k = static_cast<double>(i);
        at_most += std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1) + k * std::log(share) +
                            (n - k) * std::log1p(-share));
        if (at_most <= tail) ranks.first = i;
        if (at_most >= 1 - tail) ranks.second = i, high = true;
    }
    return ranks;
}

void check_errors(L2Cache& cache, const NeighbourAttributeOptions& options, const AttributePlaces& places,
                  NeighbourAttributeReport& report)
{
    const std::vector<PointPlace> sample = random_points(cache.tree(), checked_points, check_seed);
    std::vector<Errors> errors(sample.size());
    with_points(sample.size(), cache, options, places, [&](SinglePoints& points, BlockCache&, std::size_t i) {
        errors[i] = errors_of(stored_values(cache, places, sample[i]), points.at(sample[i]));
    });
    report.points_checked = sample.size();
    const auto wanted = kinds_of(options.wanted);
    for (std::size_t kind = 0; kind < kinds && !sample.empty(); ++kind) {
        if (!wanted[kind]) continue;
        std::vector<double> values;
        for (const Errors& e : errors) values.push_back(e[kind]);
        SampledError error{kind_names[kind], kind == normals ? "degrees" : "%", 0, 0};
        error.median = quantile(values, 0.5);
        error.p95 = quantile(values, 0.95);
        std::sort(values.begin(), values.end());
        const auto [low, high] = ranks_around_p95(values.size());
        error.p95_low = values[low];
        error.p95_high = values[high];
        report.errors.push_back(std::move(error));
    }
}

std::optional<std::uint16_t> choose_level(L2Cache& cache, const NeighbourAttributeOptions& options,
                                          const AttributePlaces& places, Watch& watch, std::vector<std::string>& notes,
                                          std::optional<PredictedTime>* predicted)
{
    const TreeInfo& info = cache.tree().info();
    if (info.levels == 0) return {};
    std::size_t level = info.levels - 1u;  // all points
    if (options.error_target_percent) {
        watch.report("Measuring errors of the levels", 0, true);
        const std::vector<double> errors = errors_of_levels(cache, options, places);
        level = 0;
        while (level + 1 < errors.size() && errors[level] > *options.error_target_percent) ++level;
    }
    if (options.time_limit) {
        watch.report("Measuring the time of the search", 0, true);
        const PredictedTime time = predict_time(cache, options, places, 0.1 * *options.time_limit);
        if (predicted) *predicted = time;
        const double left = *options.time_limit - watch.seconds();
        const std::size_t for_error = level;
        while (level > 0 && time.of_level(cache.tree(), level) > left) --level;
        if (time.of_level(cache.tree(), level) > left)
            notes.push_back("level 0 is predicted to take longer than the time limit: " +
                            std::to_string(std::lround(time.of_level(cache.tree(), level))) + " s");
        if (options.error_target_percent && level < for_error)
            notes.push_back("the error target asks for level " + std::to_string(for_error) +
                            ", for which the time limit is predicted to be too short");
    }
    if (level + 1 == info.levels) return {};
    return static_cast<std::uint16_t>(level);
}

}  // namespace pcm
