#include "pcm/cli/common.h"
#include "pcm/cli/region_options.h"
#include "pcm/cli/set_actions.h"
#include "pcm/cloud/vector.h"
#include "pcm/filter/set_points.h"
#include "pcm/point_cloud.h"
#include "pcm/select/front_points.h"
#include "pcm/select/grow.h"
#include "pcm/select/grow_from.h"
#include "pcm/select/select_points.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"
#include "pcm/view/camera.h"

#include <chrono>
#include <cstdio>
#include <memory>
#include <utility>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree;
    RegionOptions region;
    std::optional<std::uint16_t> level;
    std::vector<double> brush, grow_from;
    std::optional<double> radius, distance, within, normal_angle, colour_difference;
    std::vector<double> front;
    bool grow = false, invert = false;
    SetActions actions;
    std::uint64_t memory = std::uint64_t(256) << 20;
    std::uint32_t threads = 0;
};

[[noreturn]] void refuse(const std::string& what) { throw UsageError(what); }

void check(const Arguments& a)
{
    a.actions.check(a.tree);
    if (a.brush.empty() != !a.radius) refuse("--brush X Y Z ... and --radius need each other");
    if (a.brush.size() % 3 != 0) refuse("--brush takes three numbers for each point of the stroke");
    const bool grows = a.grow || !a.grow_from.empty();
    if (grows != a.distance.has_value())
        refuse(grows ? "--grow and --grow-from need --distance, the longest step from point to point"
                     : "--distance is for --grow and --grow-from");
    if (a.grow && !a.grow_from.empty()) refuse("--grow and --grow-from cannot be combined");
    if (!a.brush.empty() && !a.grow_from.empty())
        refuse("--brush and --grow-from cannot be combined; --grow grows the brush");
    const bool has_limits = a.within || a.normal_angle || a.colour_difference;
    if (has_limits && a.grow_from.empty())
        refuse("--within, --normal-angle and --colour-difference, which compare with the seed, go with --grow-from");
    if (!a.front.empty() && (grows || !a.brush.empty())) refuse("--front goes with a lasso alone");
    if (a.level && grows) refuse("--level and growing cannot be combined: steps pass through all points");
}

SelectOptions options_of(const Arguments& arguments)
{
    SelectOptions options;
    options.level = arguments.level;
    options.threads = arguments.threads;
    options.progress = console_progress(arguments.common);
    return options;
}

GrowOptions growth_of(const Arguments& arguments, Selection limit)
{
    GrowOptions options;
    options.limit = std::move(limit);
    options.memory_bytes = arguments.memory;
    options.threads = arguments.threads;
    options.progress = console_progress(arguments.common);
    return options;
}

// Grown from the point nearest to the one that was given, through what the region and the conditions choose.
PointSet grown_from_point(const Arguments& arguments, const std::shared_ptr<const Tree>& tree, Selection limit)
{
    const Vec3d given{arguments.grow_from[0], arguments.grow_from[1], arguments.grow_from[2]};
    const auto nearest = PointCloud::open(tree->folder())->nearest(given, 1);
    if (nearest.points.empty())
        throw Error(ErrorCode::invalid_argument, tree->folder(), "there is no point to grow from: the tree is empty");
    const Neighbour& seed = nearest.points[0];
    SeedLimits like_seed;
    like_seed.within = arguments.within;
    like_seed.colour_difference = arguments.colour_difference;
    if (arguments.normal_angle) like_seed.normal_angle = *arguments.normal_angle * pi / 180;
    if (!arguments.common.json)
        std::printf("grown from the point at %s, %s source units from the one given\n", exact(seed.position).c_str(),
                    brief(seed.distance()).c_str());
    PointSet set =
        grow_from(tree, seed.node, seed.index, *arguments.distance, like_seed, growth_of(arguments, std::move(limit)));
    if (set.empty())
        throw Error(ErrorCode::invalid_argument, tree->folder(),
                    "the point nearest to " + exact(given) + ", at " + exact(seed.position) +
                        ", is not among those that the region, the clips and the conditions choose",
                    "grow from another place, or choose this one too");
    return set;
}

// Of the lasso, the points that nothing hides.
PointSet front_of_lasso(const Arguments& arguments, const std::shared_ptr<const Tree>& tree, Selection selection)
{
    const Region::View* const view = selection.region ? selection.region->view() : nullptr;
    if (!view) refuse("--front needs a lasso: --region \"lasso ...\"");
    Camera camera;
    camera.modelview = view->modelview;
    camera.projection = view->projection;
    camera.origin = view->origin;
    const auto pixels = [](double given) {
        return given >= 1 && given <= 1e6 ? static_cast<int>(given) : 0;  // 0 is refused with the limits
    };
    camera.width = pixels(arguments.front[0]);
    camera.height = pixels(arguments.front[1]);
    const std::vector<Vec2d> polygon = view->polygon;
    FrontOptions options;
    selection.region.reset();
    options.shown = std::move(selection);
    options.select = options_of(arguments);
    return front_points(tree, camera, polygon, options);
}

PointSet choose(const Arguments& arguments, const std::shared_ptr<const Tree>& tree)
{
    const Selection selection = arguments.region.get();
    if (!arguments.grow_from.empty()) return grown_from_point(arguments, tree, selection);
    if (!arguments.front.empty()) return front_of_lasso(arguments, tree, selection);
    if (!selection.chooses_points() && arguments.brush.empty() && !arguments.level)
        throw Error(ErrorCode::invalid_argument, arguments.tree, "no points were chosen",
                    "give a region, a condition, --brush or --grow-from");
    std::vector<Vec3d> stroke;
    for (std::size_t i = 0; i < arguments.brush.size(); i += 3)
        stroke.push_back({arguments.brush[i], arguments.brush[i + 1], arguments.brush[i + 2]});
    PointSet set = stroke.empty() ? select_points(tree, selection, options_of(arguments))
                                  : brush_points(tree, stroke, *arguments.radius, selection, options_of(arguments));
    if (!arguments.grow) return set;
    Selection limit;
    limit.clips = selection.clips;
    return grow(set, *arguments.distance, growth_of(arguments, std::move(limit)));
}

Json json_of(const Box3d& box) { return box.empty() ? Json() : Json({{"min", box.min}, {"max", box.max}}); }

void print(const Arguments& arguments, const PointSet& set, const SetStatistics& statistics, const SetDone& done,
           double seconds)
{
    std::vector<std::string> notes = done.notes;
    const bool grown = arguments.grow || !arguments.grow_from.empty();
    if (grown && !arguments.invert)
        if (const std::string note = note_on_growth(set); !note.empty()) notes.insert(notes.begin(), note);
    const Box3d cloud = set.tree().info().bounds();
    if (arguments.common.json) {
        Json json;
        json["tree"] = arguments.tree;
        json["points"] = statistics.points;
        json["box"] = json_of(statistics.box);
        Json classes = Json::object();
        for (const auto& [value, points] : statistics.classes) classes[std::to_string(value)] = points;
        json["classes"] = std::move(classes);
        json["tree_bounds"] = json_of(cloud);
        json["set_bytes"] = set.bytes();
        put_done(json, done);
        json["seconds"] = seconds;
        json["peak_rss_bytes"] = peak_memory_bytes();
        json["notes"] = notes;
        json["warnings"] = done.outcome.warnings;
        print_json(json);
        return;
    }
    if (statistics.points == 0) {
        std::printf("note: no point is selected; %s\n", extent_text(cloud).c_str());
    } else {
        std::printf("%s: %s of %s points selected, from %s to %s\n", arguments.tree.c_str(),
                    grouped(statistics.points).c_str(), grouped(set.tree().info().points).c_str(),
                    exact(statistics.box.min).c_str(), exact(statistics.box.max).c_str());
        for (const auto& [value, points] : statistics.classes)
            std::printf("  class %lld: %s points\n", static_cast<long long>(value), grouped(points).c_str());
    }
    print_done(done);
    for (const std::string& note : notes) std::printf("note: %s\n", note.c_str());
    std::printf("%.1f s, peak memory %s\n", seconds, bytes_text(peak_memory_bytes()).c_str());
}

int select(Arguments& arguments)
{
    const auto start = std::chrono::steady_clock::now();
    check(arguments);
    const auto tree = Tree::open(arguments.tree);
    PointSet set = choose(arguments, tree);
    if (arguments.invert) set.invert();
    const SetStatistics statistics = statistics_of(set, arguments.threads, console_progress(arguments.common));
    const SetDone done = arguments.actions.run(set, arguments.common, arguments.memory, arguments.threads);
    end_progress(arguments.common);
    print(arguments, set, statistics, done,
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return finished(done.outcome);
}

void add_choices(Options& options, Arguments& arguments)
{
    const char* const group = "Points to select";
    arguments.region.add_to(options, group);
    options.option("--level", arguments.level, "Only the points up to this level").group(group);
    options
        .option("--brush", arguments.brush,
                "Points near the stroke through x0 y0 z0 x1 y1 z1 ... (one point: a sphere), within --radius; of those "
                "that a region or a condition chooses")
        .values(3, 300000)
        .group(group);
    options.option("--radius", arguments.radius, "Radius of the brush, source units").not_negative().group(group);
    options
        .option(
            "--grow-from", arguments.grow_from,
            "All points that steps of at most --distance reach from the point nearest to x y z, through points that "
            "the region, the clips and the conditions choose")
        .values(3)
        .group(group);
    options
        .flag("--grow", arguments.grow,
              "Add to the chosen points all that steps of at most --distance reach from them; clips limit it")
        .group(group);
    options.option("--distance", arguments.distance, "Longest step from point to point, source units")
        .positive()
        .group(group);
    options.option("--within", arguments.within, "With --grow-from: no farther from the seed, source units")
        .not_negative()
        .group(group);
    options
        .option(
            "--normal-angle", arguments.normal_angle,
            "With --grow-from: only points whose normal is within this angle of the seed's, of either sign; degrees, "
            "as in 20")
        .between(0.0, 90.0)
        .group(group);
    options
        .option(
            "--colour-difference", arguments.colour_difference,
            "With --grow-from: only points whose colour is this near to the seed's: the distance between red, green "
            "and blue of 0 to 255 each, as in 40")
        .between(0.0, 441.7)
        .group(group);
    options
        .option(
            "--front", arguments.front,
            "Of a lasso (--region \"lasso ...\") only points that no others hide, in a view of so many pixels in width "
            "and height: --front 1280 720")
        .values(2)
        .group(group);
    options.flag("--invert", arguments.invert, "Select all other points instead").group(group);
}

}  // namespace

Run add_select(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "Tree folder, or any file of it").required();
    add_choices(options, *arguments);
    arguments->actions.add_to(options, "What to do with them (default: count them)");
    options.option("-m,--memory", arguments->memory, "Memory for growing and writing, e.g. 512M (default 256M)")
        .bytes();
    options.option("-t,--threads", arguments->threads, "Threads (default: one per processor)");
    add_common(options, arguments->common);
    return [arguments] { return select(*arguments); };
}

}  // namespace pcm::cli
