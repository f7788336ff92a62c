// Points in a region, nearest neighbours, the first hit of a ray, and what a query would cost.
#include "pcm/ops/shared/cache_report.h"
#include "pcm/ops/shared/level_arguments.h"
#include "pcm/ops/shared/region_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/point_cloud.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>

namespace pcm::ops {
namespace {

Json json_of(const Vec3d& v) { return Json::array({v[0], v[1], v[2]}); }

Json json_of(const Box3d& box)
{
    return box.empty() ? Json() : Json({{"min", json_of(box.min)}, {"max", json_of(box.max)}});
}

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(); }

void refuse_query(const std::string& what, const std::string& hint)
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

std::string level_text(std::uint16_t level, double error)
{
    return "level " + std::to_string(level) + " only: every point of the cloud is nearer than " + brief(error) +
           " to a point of this level";
}

std::vector<ResultKey> query_keys()
{
    return {{"bounds", "object?", "source units", "--count: min and max of the points; null: there are none"},
            {"tree_bounds", "object?", "source units", "--count: min and max of the tree"},
            {"chunks", "count?", "", "--count, --estimate: chunks that were or would be read"},
            {"spacing", "number?", "source units", "--count: every point of the cloud is nearer to one of the level"},
            {"points_least", "count?", "points", "--estimate"},
            {"points_expected", "number?", "points", "--estimate"},
            {"points_most", "count?", "points", "--estimate"},
            {"conditions_reckoned_with", "flag?", "", "--estimate: false: numbers are before the conditions"},
            {"points_to_read", "count?", "points", "--estimate: to be examined, at most"},
            {"bytes", "count?", "bytes", "--estimate: to be read"},
            {"seconds_expected", "number?", "s", "--estimate: null: nothing was read from this tree yet"},
            {"neighbours", "list?", "", "--nearest: of each distance, position, node and index"},
            {"least_distance", "number?", "source units", "--nearest: no point of the cloud is nearer"},
            {"points_compared", "count?", "points", "--nearest"},
            {"hit", "object?", "", "--first-hit: along, position, node and index"},
            {"cache", "object?", "", "--statistics: of the cache of chunks"}};
}

class QueryPoints : public Operation {
public:
    QueryPoints()
    {
        arguments_.add("tree", tree_)
            .as(ValueKind::tree)
            .positional()
            .required()
            .help("Tree folder, or any file of it");
        declare_questions();
        const char* const group = "Points";
        level_.declare(arguments_, "Only the points up to this level", group);
        region_.declare(arguments_, group);
        arguments_.add("reads", reads_).between(1, 64).help("Chunks read concurrently; use more on slow file systems");
        arguments_.add("cache", cache_.capacity_bytes)
            .as(ValueKind::bytes)
            .help("Cache for whole chunks, such as 256M or 2G");
        arguments_.add("statistics", statistics_).help("Print cache statistics");
    }

    Result answer(const Context& context) override
    {
        const auto cloud = PointCloud::open(tree_, cache_);
        const Query query = make_query(context, *cloud);
        if (estimate_ + count_ + first_hit_ + !nearest_.empty() > 1)
            refuse_query("--estimate, --count, --nearest and --first-hit cannot be combined", "give one of them");
        if (headers_ && !estimate_) refuse_query("--headers needs --estimate", "");
        if (max_distance_ && nearest_.empty()) refuse_query("--max-distance needs --nearest", "");
        Result result;
        result.input = {tree_};
        for (const ResultKey& key : query_keys())
            result.values[key.key] = Json();  // those of other questions stay null
        if (estimate_)
            estimate(*cloud, query, result);
        else if (!nearest_.empty())
            nearest(*cloud, query, result);
        else if (first_hit_)
            first_hit(*cloud, query, result);
        else
            count(*cloud, query, result);
        if (statistics_) {
            result.values["cache"] = cache_json(cloud->cache().statistics());
            put_cache_lines(result, cloud->cache().statistics());
        }
        return result;
    }

private:
    void declare_questions()
    {
        const char* const group = "Query";
        arguments_.add("count", count_)
            .group(group)
            .help("Number of points and their bounding box; the answer where nothing else is requested");
        arguments_.add("estimate", estimate_)
            .group(group)
            .help("Estimated number of points and cost of reading them, without reading any");
        arguments_.add("headers", headers_)
            .group(group)
            .help("With --estimate: also read the headers of chunks, for tighter bounds");
        arguments_.add("nearest", nearest_)
            .count(3)
            .group(group)
            .help("The points nearest to x y z: --nearest 1 2 3 -k 8");
        arguments_.add("neighbours", k_).letter('k').between(1, 1e9).group(group).help("Number of neighbours");
        arguments_.add("max_distance", max_distance_)
            .unit("source units")
            .group(group)
            .help("Ignore neighbours farther than this")
            .without("none");
        arguments_.add("first_hit", first_hit_).group(group).help("The first point hit by --ray or --cone");
    }

    Query make_query(const Context& context, const PointCloud& cloud) const
    {
        Query query;
        query.level = level_.of(*cloud.tree());
        if (arguments_.given("neighbours") && nearest_.empty()) throw ArgumentError("-k requires --nearest");
        query.choose(region_.get());
        query.reads_in_flight = reads_;
        query.progress = context.progress;
        return query;
    }

    // After an answer without points: where they would have been.
    static void put_extent(const PointCloud& cloud, Result& result) { result.line(extent_text(cloud.info().bounds())); }

    void estimate(PointCloud& cloud, const Query& query, Result& result) const
    {
        const Estimate e = cloud.estimate(query, headers_ ? EstimatePrecision::headers : EstimatePrecision::index);
        const auto expected = static_cast<std::uint64_t>(std::llround(e.points_expected));
        result.outcome.points_out = expected;
        const double off = std::max(e.points_expected - static_cast<double>(e.points_least),
                                    static_cast<double>(e.points_most) - e.points_expected);
        result.accuracy = exact_answer();
        if (off > 0) result.accuracy = {ErrorKind::bound, off, "points", "the number of points"};
        Json& json = result.values;
        json["points_least"] = e.points_least;
        json["points_expected"] = e.points_expected;
        json["points_most"] = e.points_most;
        json["conditions_reckoned_with"] = !e.conditions;
        json["chunks"] = e.chunks;
        json["points_to_read"] = e.points_read;
        json["bytes"] = e.bytes;
        json["seconds_expected"] = e.seconds ? Json(*e.seconds) : Json();
        result.line("points      about " + grouped(expected) + (e.conditions ? " before the conditions" : "") +
                    "; from " + grouped(e.points_least) + " to " + grouped(e.points_most));
        result.line("to read     " + grouped(e.chunks) + " chunks, at most " + points_text(e.points_read) + " and " +
                    bytes_text(e.bytes));
        result.line(e.seconds ? "time        about " + time_text(*e.seconds)
                              : "time        unknown: nothing was read from this tree yet; --count measures it");
        if (e.points_most == 0) put_extent(cloud, result);
        result.line("estimated in " + time_text(e.own_seconds) + " from " +
                    (headers_ ? "the index and the headers of chunks" : "the index"));
    }

    void count(PointCloud& cloud, const Query& query, Result& result) const
    {
        Outcome& outcome = result.outcome;
        Box3i box;
        PointCursor cursor = cloud.points(query);
        for (PointView view; cursor.getNextData(view); outcome.points_out += view.size())
            for (std::size_t i = 0; i < view.size(); ++i) box.extend(view.grid_position(i));
        const Box3d found = cloud.info().grid.to_source(box);
        const CursorStatistics statistics = cursor.statistics();
        outcome.points_in = statistics.points_read;
        if (query.level) outcome.error = level_spacing(*cloud.tree(), *query.level);
        result.accuracy = without_finer_levels(outcome.error);
        Json& json = result.values;
        json["bounds"] = json_of(found);
        json["tree_bounds"] = json_of(cloud.info().bounds());
        json["chunks"] = statistics.chunks;
        json["spacing"] = finite(outcome.error);
        result.line(points_text(outcome.points_out) + "; " + points_text(statistics.points_read) + " of " +
                    grouped(statistics.chunks) + " chunks examined");
        if (found.empty()) {
            put_extent(cloud, result);
        } else {
            result.line("from        " + exact(found.min));
            result.line("to          " + exact(found.max));
        }
        result.line(!query.level || outcome.error == 0 ? "exact: every point of the cloud was considered"
                                                       : level_text(*query.level, outcome.error));
    }

    void nearest(PointCloud& cloud, const Query& query, Result& result) const
    {
        if (query.region || query.box || !query.where.empty())
            refuse_query("--nearest cannot be combined with a region, a box or a condition",
                         "it searches the whole cloud, or one --level");
        NearestOptions options;
        options.level = query.level;
        if (max_distance_) options.max_distance = *max_distance_;
        const NearestResult found = cloud.nearest({nearest_[0], nearest_[1], nearest_[2]}, k_, options);
        const Outcome& outcome = result.outcome = found.outcome;
        result.accuracy = bounded(outcome.error, "the distance of the nearest point");
        Json points = Json::array();
        for (const Neighbour& n : found.points) {
            points.push_back(
                {{"distance", n.distance()}, {"position", json_of(n.position)}, {"node", n.node}, {"index", n.index}});
            result.print("%-14s  at %s", brief(n.distance()).c_str(), exact(n.position).c_str());
        }
        Json& json = result.values;
        json["neighbours"] = std::move(points);
        json["least_distance"] = finite(found.least_distance);
        json["points_compared"] = outcome.points_in;
        if (found.points.empty()) put_extent(cloud, result);
        const std::string precision =
            outcome.error == 0
                ? "exact"
                : "level " + std::to_string(*query.level) + " only: no point of the cloud is nearer than " +
                      brief(found.least_distance) + ", which is " + brief(outcome.error) + " less";
        result.line(points_text(found.points.size()) + " in " + time_text(outcome.seconds) + ", " +
                    grouped(outcome.points_in) + " compared; " + precision);
    }

    void first_hit(PointCloud& cloud, const Query& query, Result& result) const
    {
        if (!query.region || (query.region->kind() != Region::Kind::ray && query.region->kind() != Region::Kind::cone))
            refuse_query("--first-hit needs --ray or --cone", "give an origin, a direction and a width");
        if (query.box || !query.where.empty())
            refuse_query("--first-hit cannot be combined with a box or a condition", "");
        const HitResult found = cloud.first_hit(*query.region, query.level);
        result.outcome = found.outcome;
        const double error = found.outcome.error;
        result.accuracy = without_finer_levels(error);
        Json& json = result.values;
        json["hit"] = Json();
        std::string text = "no hit, in ";
        if (found.hit) {
            json["hit"] = {{"along", found.hit->along},
                           {"position", json_of(found.hit->position)},
                           {"node", found.hit->node},
                           {"index", found.hit->index}};
            text = exact(found.hit->position) + ", " + brief(found.hit->along) + " along, in ";
        }
        result.line(text + time_text(found.outcome.seconds) +
                    (error == 0 ? "; exact" : "; " + level_text(*query.level, error)));
        if (!found.hit) put_extent(cloud, result);
    }

    std::string tree_;
    RegionArguments region_;
    std::vector<double> nearest_;
    LevelArguments level_;
    bool estimate_ = false, headers_ = false, count_ = false, first_hit_ = false, statistics_ = false;
    std::uint64_t k_ = 1;
    std::optional<double> max_distance_;
    std::uint32_t reads_ = 8;
    L2Options cache_;
};

}  // namespace

Row query_row()
{
    return {"query",
            nullptr,
            "Query a tree: points in a region, nearest neighbours, first hit of a ray",
            "Answers one of four questions about the points of a tree: how many lie in a region and within which box, "
            "what reading them would cost, which are the nearest ones to a place, and which one a ray meets first.",
            0,
            nullptr,
            query_keys(),
            make<QueryPoints>,
            {},
            follows_from_points_read};
}

}  // namespace pcm::ops
