#include "pcm/point_cloud.h"

#include "pcm/cli/cache_statistics.h"
#include "pcm/cli/common.h"
#include "pcm/cli/region_options.h"
#include "pcm/system/error.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    RegionOptions region;
    std::string tree;
    std::vector<double> nearest;
    std::optional<std::uint16_t> level;
    bool estimate = false, headers = false, count = false, first_hit = false, statistics = false;
    std::size_t k = 1;
    std::optional<double> max_distance;
    unsigned reads = 8;
    std::uint64_t cache = std::uint64_t(512) << 20;
};

Json json_of(const Vec3d& v) { return Json::array({v[0], v[1], v[2]}); }

Json json_of(const Box3d& box)
{
    return box.empty() ? Json() : Json({{"min", json_of(box.min)}, {"max", json_of(box.max)}});
}

void refuse(const std::string& what, const std::string& hint)
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

Query query_of(const Arguments& arguments, const PointCloud& cloud)
{
    Query query;
    query.level = arguments.level;
    const std::uint16_t levels = cloud.info().levels;
    if (query.level && levels > 0 && *query.level >= levels)
        refuse("there is no level " + std::to_string(*query.level) + "; this tree has levels 0 to " +
                   std::to_string(levels - 1),
               "");
    const Selection selection = arguments.region.get();
    query.choose(selection);
    query.reads_in_flight = arguments.reads;
    query.progress = console_progress(arguments.common);
    return query;
}

// After an answer without points: where they would have been.
void print_extent(const PointCloud& cloud) { std::printf("%s\n", extent_text(cloud.info().bounds()).c_str()); }

int estimate(const Arguments& arguments, PointCloud& cloud, const Query& query)
{
    const Estimate e = cloud.estimate(query, arguments.headers ? EstimatePrecision::headers : EstimatePrecision::index);
    if (arguments.common.json) {
        Json json;
        json["points_least"] = e.points_least;
        json["points_expected"] = e.points_expected;
        json["points_most"] = e.points_most;
        json["conditions_reckoned_with"] = !e.conditions;
        json["chunks"] = e.chunks;
        json["points_read"] = e.points_read;
        json["bytes"] = e.bytes;
        json["seconds_expected"] = e.seconds ? Json(*e.seconds) : Json();
        json["seconds"] = e.own_seconds;
        if (arguments.statistics) json["cache"] = cache_json(cloud.cache().statistics());
        print_json(json);
        return 0;
    }
    std::printf("points      about %s%s; from %s to %s\n",
                grouped(static_cast<std::uint64_t>(std::llround(e.points_expected))).c_str(),
                e.conditions ? " before the conditions" : "", grouped(e.points_least).c_str(),
                grouped(e.points_most).c_str());
    std::printf("to read     %s chunks, at most %s points and %s\n", grouped(e.chunks).c_str(),
                grouped(e.points_read).c_str(), bytes_text(e.bytes).c_str());
    if (e.seconds)
        std::printf("time        about %s\n", time_text(*e.seconds).c_str());
    else
        std::printf("time        unknown: nothing was read from this tree yet; --count measures it\n");
    if (e.points_most == 0) print_extent(cloud);
    std::printf("estimated in %s from %s\n", time_text(e.own_seconds).c_str(),
                arguments.headers ? "the index and the headers of chunks" : "the index");
    return 0;
}

int count(const Arguments& arguments, PointCloud& cloud, const Query& query)
{
    const auto start = std::chrono::steady_clock::now();
    Outcome outcome;
    Box3i box;
    PointCursor cursor = cloud.points(query);
    for (PointView view; cursor.getNextData(view); outcome.points_out += view.size())
        for (std::size_t i = 0; i < view.size(); ++i) box.extend(view.grid_position(i));
    const Box3d found = cloud.info().grid.to_source(box);
    outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const CursorStatistics statistics = cursor.statistics();
    outcome.points_in = statistics.points_read;
    if (query.level) outcome.error = level_spacing(*cloud.tree(), *query.level);
    end_progress(arguments.common);
    if (arguments.common.json) {
        Json json;
        json["tree"] = arguments.tree;
        put_outcome(json, outcome);
        json["bounds"] = json_of(found);
        json["tree_bounds"] = json_of(cloud.info().bounds());
        json["chunks"] = statistics.chunks;
        json["points_read"] = statistics.points_read;
        json["bytes_read"] = statistics.bytes_read;
        json["spacing"] = std::isfinite(outcome.error) ? Json(outcome.error) : Json();
        if (arguments.statistics) json["cache"] = cache_json(cloud.cache().statistics());
        print_json(json);
        return 0;
    }
    std::printf("%s points in %s; %s points of %s chunks examined\n", grouped(outcome.points_out).c_str(),
                time_text(outcome.seconds).c_str(), grouped(statistics.points_read).c_str(),
                grouped(statistics.chunks).c_str());
    if (found.empty())
        print_extent(cloud);
    else
        std::printf("from        %s\nto          %s\n", exact(found.min).c_str(), exact(found.max).c_str());
    if (!query.level || outcome.error == 0)
        std::printf("exact: every point of the cloud was considered\n");
    else
        std::printf("level %u only: every point of the cloud is nearer than %s to a point of this level\n",
                    *query.level, brief(outcome.error).c_str());
    return 0;
}

int nearest(const Arguments& arguments, PointCloud& cloud, const Query& query)
{
    if (query.region || query.box || !query.where.empty())
        refuse("--nearest cannot be combined with a region, a box or a condition",
               "it searches the whole cloud, or one --level");
    NearestOptions options;
    options.level = query.level;
    if (arguments.max_distance) options.max_distance = *arguments.max_distance;
    const NearestResult result =
        cloud.nearest({arguments.nearest[0], arguments.nearest[1], arguments.nearest[2]}, arguments.k, options);
    const Outcome& outcome = result.outcome;
    if (arguments.common.json) {
        Json json, points = Json::array();
        for (const Neighbour& n : result.points)
            points.push_back(
                {{"distance", n.distance()}, {"position", json_of(n.position)}, {"node", n.node}, {"index", n.index}});
        json["tree"] = arguments.tree;
        put_outcome(json, outcome);
        json["neighbours"] = points;
        json["least_distance"] = std::isfinite(result.least_distance) ? Json(result.least_distance) : Json();
        json["error"] = std::isfinite(outcome.error) ? Json(outcome.error) : Json();
        json["points_compared"] = outcome.points_in;
        if (arguments.statistics) json["cache"] = cache_json(cloud.cache().statistics());
        print_json(json);
        return 0;
    }
    for (const Neighbour& n : result.points)
        std::printf("%-14s  at %s\n", brief(n.distance()).c_str(), exact(n.position).c_str());
    if (result.points.empty()) print_extent(cloud);
    std::printf("%zu points in %s, %s compared; ", result.points.size(), time_text(outcome.seconds).c_str(),
                grouped(outcome.points_in).c_str());
    if (outcome.error == 0)
        std::printf("exact\n");
    else
        std::printf("level %u only: no point of the cloud is nearer than %s, which is %s less\n", *query.level,
                    brief(result.least_distance).c_str(), brief(outcome.error).c_str());
    return 0;
}

int first_hit(const Arguments& arguments, PointCloud& cloud, const Query& query)
{
    if (!query.region || (query.region->kind() != Region::Kind::ray && query.region->kind() != Region::Kind::cone))
        refuse("--first-hit needs --ray or --cone", "give an origin, a direction and a width");
    if (query.box || !query.where.empty()) refuse("--first-hit cannot be combined with a box or a condition", "");
    const HitResult result = cloud.first_hit(*query.region, query.level);
    if (arguments.common.json) {
        Json json;
        json["tree"] = arguments.tree;
        put_outcome(json, result.outcome);
        json["hit"] = Json();
        if (result.hit)
            json["hit"] = {{"along", result.hit->along},
                           {"position", json_of(result.hit->position)},
                           {"node", result.hit->node},
                           {"index", result.hit->index}};
        json["error"] = std::isfinite(result.outcome.error) ? Json(result.outcome.error) : Json();
        if (arguments.statistics) json["cache"] = cache_json(cloud.cache().statistics());
        print_json(json);
        return 0;
    }
    if (result.hit)
        std::printf("%s, %s along, in %s", exact(result.hit->position).c_str(), brief(result.hit->along).c_str(),
                    time_text(result.outcome.seconds).c_str());
    else
        std::printf("no hit, in %s", time_text(result.outcome.seconds).c_str());
    if (result.outcome.error == 0)
        std::printf("; exact\n");
    else
        std::printf("; level %u only: every point of the cloud is nearer than %s to a point of this level\n",
                    *query.level, brief(result.outcome.error).c_str());
    if (!result.hit) print_extent(cloud);
    return 0;
}

int query(const Arguments& arguments)
{
    L2Options cache;
    cache.capacity_bytes = arguments.cache;
    const auto cloud = PointCloud::open(arguments.tree, cache);
    const Query query = query_of(arguments, *cloud);
    if (arguments.estimate + arguments.count + arguments.first_hit + !arguments.nearest.empty() > 1)
        refuse("--estimate, --count, --nearest and --first-hit cannot be combined", "give one of them");
    if (arguments.headers && !arguments.estimate) refuse("--headers needs --estimate", "");
    if (arguments.max_distance && arguments.nearest.empty()) refuse("--max-distance needs --nearest", "");
    int result = 0;
    if (arguments.estimate)
        result = estimate(arguments, *cloud, query);
    else if (!arguments.nearest.empty())
        result = nearest(arguments, *cloud, query);
    else if (arguments.first_hit)
        result = first_hit(arguments, *cloud, query);
    else
        result = count(arguments, *cloud, query);
    if (arguments.statistics && !arguments.common.json) print(cloud->cache().statistics());
    return result;
}

}  // namespace

Run add_query(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "Tree folder, or any file of it").required();

    const char* group = "Query";
    options.flag("--count", arguments->count, "Number of points and their bounding box (default)").group(group);
    options
        .flag("--estimate", arguments->estimate,
              "Estimated number of points and cost of reading them, without reading any")
        .group(group);
    options
        .flag("--headers", arguments->headers, "With --estimate: also read the headers of chunks, for tighter bounds")
        .group(group);
    const Option nearest =
        options.option("--nearest", arguments->nearest, "The points nearest to x y z: --nearest 1 2 3 -k 8")
            .values(3)
            .group(group);
    options.option("-k", arguments->k, "Number of neighbours (default 1)").positive().needs(nearest).group(group);
    options.option("--max-distance", arguments->max_distance, "Ignore neighbours farther than this").group(group);
    options.flag("--first-hit", arguments->first_hit, "The first point hit by --ray or --cone").group(group);

    group = "Points";
    options.option("--level", arguments->level, "Only the points up to this level (default: all levels)").group(group);
    arguments->region.add_to(options, group);

    options.option("--reads", arguments->reads, "Chunks read concurrently (default 8); use more on slow file systems")
        .between(1, 64);
    options.option("--cache", arguments->cache, "Cache for whole chunks, e.g. 256M or 2G (default 512M)").bytes();
    options.flag("--statistics", arguments->statistics, "Print cache statistics");
    add_common(options, arguments->common);
    return [arguments] { return query(*arguments); };
}

}  // namespace pcm::cli
