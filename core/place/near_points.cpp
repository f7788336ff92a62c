#include "pcm/place/near_points.h"

#include "pcm/bpc/chunk.h"
#include "pcm/cloud/box_distance.h"
#include "pcm/cloud/coordinates.h"
#include "pcm/cloud/numbers.h"
#include "pcm/place/normal_column.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/threads/watch.h"
#include "pcm/tree/selected_nodes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

namespace pcm {
namespace {

constexpr std::size_t most_asked = 10000000;
constexpr std::size_t spacing_sample = 256;

void require(const Vec3d& place, const NearOptions& options)
{
    require_place("the place", place);
    if (!(options.radius >= 0) || !std::isfinite(options.radius))
        throw Error(ErrorCode::invalid_argument, {},
                    "the radius of the neighbourhood is " + exact(options.radius) +
                        "; it is a positive number of source units");
    if ((options.radius > 0) == (options.count > 0))
        throw Error(ErrorCode::invalid_argument, {},
                    options.count > 0 ? "both a radius and a number of points were given for the neighbourhood"
                                      : "the neighbourhood has neither a radius nor a number of points",
                    "give one of them");
    if (options.count > most_asked || options.most > most_asked || options.most == 0)
        throw Error(ErrorCode::invalid_argument, {},
                    "a neighbourhood of " +
                        grouped(options.most == 0 ? 0 : std::max<std::uint64_t>(options.count, options.most)) +
                        " points was asked for; it has 1 to " + grouped(most_asked));
}

// Splits numbers that follow one another (SplitMix64).
std::uint64_t scattered(std::uint64_t x)
{
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

struct NearPoint {
    double square;
    NodeId node;
    std::uint32_t number;
    std::uint64_t rank;  // random: order in which points of a level are kept when there are too many
    std::uint16_t level;
    Vec3d position, normal;
};

bool nearer(const NearPoint& a, const NearPoint& b)
{
    return std::tie(a.square, a.node, a.number) < std::tie(b.square, b.node, b.number);
}

bool is_before(const NearPoint& a, const NearPoint& b)
{
    return std::tie(a.level, a.rank, a.node, a.number) < std::tie(b.level, b.rank, b.node, b.number);
}

// The first `most` of all that are added, by an order.
template <bool (*before)(const NearPoint&, const NearPoint&)>
class FirstOnes {
public:
    explicit FirstOnes(std::size_t most) : most_(most) {}
    bool full() const { return heap_.size() == most_; }
    const NearPoint& last() const { return heap_.front(); }
    void add(const NearPoint& candidate)
    {
        if (full()) {
            if (!before(candidate, last())) return;
            std::pop_heap(heap_.begin(), heap_.end(), before);
            heap_.pop_back();
        }
        heap_.push_back(candidate);
        std::push_heap(heap_.begin(), heap_.end(), before);
    }
    std::vector<NearPoint> take() { return std::move(heap_); }

private:
    const std::size_t most_;
    std::vector<NearPoint> heap_;
};

// Reads the nodes near the place, the nearest first.
class NearSearch {
public:
    NearSearch(const Tree& tree, const Vec3d& place, const NearOptions& options)
        : tree_(tree),
          place_(place),
          options_(options),
          selector_(options.limit, tree.info().schema),
          rounding_(tree.info()),
          normals_(tree.info().schema),
          watch_(options.progress),
          nearest_(options.count > 0 ? options.count : spacing_sample),
          spread_(options.most)
    {
        columns_.positions = true;
        for (const std::size_t k : selector_.tested()) columns_.attributes.set(k);
        if (normals_.exists()) columns_.attributes.set(normals_.place());
        limit_ = options.radius > 0 ? options.radius * options.radius : infinity;
    }

    NearPoints run()
    {
        watch_.report(stage, 0, true);
        using Entry = std::pair<double, NodeId>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> nodes;
        const auto queue = [&](NodeId id) {
            if (tree_.node(id).box.empty()) return;
            const Box3d box = box_of(tree_.node(id).box);
            const double square = squared_distance(box, place_);
            if (square <= bound() && selector_.relation(box) != BoxRelation::outside) nodes.emplace(square, id);
        };
        if (!tree_.nodes().empty()) queue(0);
        while (!nodes.empty()) {
            const auto [square, id] = nodes.top();
            nodes.pop();
            if (square > bound()) break;
            watch_.report(stage, 0);
            if (tree_.node(id).points > 0) read(id);
            for (const NodeId child : tree_.node(id).children)
                if (child != no_node) queue(child);
        }
        return result();
    }

private:
    static constexpr const char* stage = "Reading the neighbourhood";

    Box3d box_of(const Box3i& box) const { return source_box(tree_.info().grid, box, rounding_); }
    bool by_count() const { return options_.count > 0; }
    // Points farther than this, by squares, are not wanted.
    double bound() const { return by_count() && nearest_.full() ? nearest_.last().square : limit_; }

    void read(NodeId id)
    {
        std::vector<BoxRelation> relations;
        std::vector<std::uint16_t> levels;
        const auto wanted = [&](const Box3i& grid_box, std::uint16_t level) {
            const Box3d box = box_of(grid_box);
            const BoxRelation relation = selector_.relation(box);
            if (relation == BoxRelation::outside || squared_distance(box, place_) > bound()) return false;
            relations.push_back(relation);
            levels.push_back(level);
            return true;
        };
        const ChunkPart part = tree_.read_chunk_part(id, columns_, wanted);
        std::uint32_t begin = 0;
        for (std::size_t k = 0; k < part.count.size(); ++k) {
            add_segment(id, part, k, begin, levels[k], relations[k]);
            begin += part.count[k];
        }
    }

    // Segment k, which begins at point `begin` of the part.
    void add_segment(NodeId id, const ChunkPart& part, std::size_t k, std::uint32_t begin, std::uint16_t level,
                     BoxRelation relation)
    {
        const Chunk& chunk = part.chunk;
        const auto position = [&](std::size_t i) {
            return rounding_(tree_.info().grid.to_source(chunk.positions->grid(i)));
        };
        std::vector<std::uint32_t> candidates;
        for (std::uint32_t i = begin; i < begin + part.count[k]; ++i)
            if (squared_distance(position(i), place_) <= bound()) candidates.push_back(i);
        std::vector<const Column*> columns(chunk.attributes.size(), nullptr);
        for (const std::size_t a : selector_.tested()) columns[a] = chunk.attributes[a].get();
        selector_.narrow(columns, position, candidates, relation);
        for (const std::uint32_t i : candidates) {
            NearPoint candidate;
            candidate.position = position(i);
            candidate.square = squared_distance(candidate.position, place_);
            candidate.node = id;
            candidate.number = part.first[k] + (i - begin);
            candidate.rank = scattered(scattered(id) ^ candidate.number);
            candidate.level = level;
            candidate.normal = normals_.exists() ? normals_.at(*chunk.attributes[normals_.place()], i) : Vec3d{};
            ++found_;
            nearest_.add(candidate);
            if (!by_count()) spread_.add(candidate);
        }
    }

    NearPoints result()
    {
        NearPoints result;
        std::vector<NearPoint> nearest = nearest_.take();
        std::sort(nearest.begin(), nearest.end(), nearer);
        result.spacing = spacing_of(nearest);
        std::vector<NearPoint> kept;
        if (by_count()) {
            result.found = nearest.size();
            if (!nearest.empty()) result.radius = std::sqrt(nearest.back().square);
            if (nearest.size() > options_.most) {
                std::sort(nearest.begin(), nearest.end(), is_before);
                nearest.resize(options_.most);
            }
            kept = std::move(nearest);
        } else {
            result.found = found_;
            result.radius = options_.radius;
            kept = spread_.take();
        }
        std::sort(kept.begin(), kept.end(), nearer);
        if (!kept.empty()) result.points.origin = kept.front().position;
        for (const NearPoint& point : kept) {
            if (normals_.exists())
                result.points.add(point.position, point.normal);
            else
                result.points.add(point.position);
            result.ids.push_back({point.node, point.number});
        }
        return result;
    }

    // The median distance of the nearest points from the nearest one at another place.
    static double spacing_of(const std::vector<NearPoint>& points)
    {
        const std::size_t count = std::min(points.size(), spacing_sample);
        std::vector<double> squares;
        for (std::size_t i = 0; i < count; ++i) {
            double least = infinity;
            for (std::size_t j = 0; j < count; ++j) {
                const double square = squared_distance(points[i].position, points[j].position);
                if (square > 0) least = std::min(least, square);
            }
            if (least < infinity) squares.push_back(least);
        }
        if (squares.empty()) return 0;
        std::nth_element(squares.begin(), squares.begin() + squares.size() / 2, squares.end());
        return std::sqrt(squares[squares.size() / 2]);
    }

    const Tree& tree_;
    const Vec3d place_;
    const NearOptions& options_;
    const Selector selector_;
    const SourceRounding rounding_;
    const NormalColumn normals_;
    Watch watch_;
    ColumnSet columns_;
    double limit_;  // a square
    std::uint64_t found_ = 0;
    FirstOnes<nearer> nearest_;
    FirstOnes<is_before> spread_;
};

// Keeps the first point at each place, and of places the first `most`.
void keep_places(NearPoints& near, std::size_t most)
{
    std::vector<std::uint32_t> order(near.ids.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto place = [&](std::uint32_t i) { return near.points.at(i); };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::make_pair(place(a), a) < std::make_pair(place(b), b);
    });
    std::vector<std::uint32_t> first;
    for (std::size_t k = 0; k < order.size(); ++k)
        if (k == 0 || place(order[k]) != place(order[k - 1])) first.push_back(order[k]);
    if (first.size() == near.ids.size() && first.size() <= most) return;
    std::sort(first.begin(), first.end());
    first.resize(std::min(first.size(), most));
    NearPoints kept = near;
    kept.points = {};
    kept.points.origin = near.points.origin;
    kept.ids.clear();
    for (const std::uint32_t i : first) {
        if (near.points.has_normals())
            kept.points.add(near.points.source(i), near.points.normal(i));
        else
            kept.points.add(near.points.source(i));
        kept.ids.push_back(near.ids[i]);
    }
    near = std::move(kept);
}

// As many nearest points as have the wanted number of places among them.
NearPoints places_near(const Tree& tree, const Vec3d& place, const NearOptions& options)
{
    constexpr std::size_t most_repeated = 256, all = std::numeric_limits<std::size_t>::max();
    if (options.count == 0) {
        NearPoints near = NearSearch(tree, place, options).run();
        keep_places(near, all);
        return near;
    }
    NearOptions more = options;
    const std::size_t most = std::min(most_repeated * options.count, std::max(options.most, options.count));
    for (;;) {
        NearPoints near = NearSearch(tree, place, more).run();
        const std::size_t read = near.ids.size();
        keep_places(near, options.count);
        if (near.ids.size() >= options.count || read < more.count || more.count >= most) {
            near.found = near.ids.size();
            if (!near.ids.empty()) near.radius = length(near.points.source(near.ids.size() - 1) - place);
            return near;
        }
        more.count = std::min(most, std::max(2 * more.count, more.count * options.count / near.ids.size()));
    }
}

}  // namespace

NearPoints points_near(const PointCloud& cloud, const Vec3d& place, const NearOptions& options)
{
    require(place, options);
    const auto tree = cloud.tree();
    return options.places ? places_near(*tree, place, options) : NearSearch(*tree, place, options).run();
}

}  // namespace pcm
