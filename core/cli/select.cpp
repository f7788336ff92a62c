#include "pcm/cli/attribute_options.h"
#include "pcm/cli/common.h"
#include "pcm/cli/region_options.h"
#include "pcm/point_cloud.h"
#include "pcm/select/front_points.h"
#include "pcm/select/grow.h"
#include "pcm/select/select_points.h"
#include "pcm/select/set_changes.h"
#include "pcm/select/set_points.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"

#include <algorithm>
#include <chrono>
#include <cmath>
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
    std::optional<double> radius, distance, within;
    std::vector<double> front;
    bool grow = false, invert = false;
    std::string attribute, extract;
    bool erase = false, overwrite = false;
    std::optional<double> classify;
    std::string classes = "classification";
    TargetOptions target;
    std::uint64_t memory = std::uint64_t(256) << 20;
    std::uint32_t threads = 0;
};

[[noreturn]] void refuse(const std::string& what) { throw UsageError(what); }

void check(const Arguments& a)
{
    const int actions = !a.attribute.empty() + !a.extract.empty() + a.erase + a.classify.has_value();
    if (actions > 1) refuse("--save-attribute, --extract, --delete and --classify cannot be combined");
    const bool changes = actions == 1 && a.extract.empty();
    const bool has_target = !a.target.output.empty() || a.target.in_place;
    if (changes && a.target.output.empty() == !a.target.in_place)
        refuse("give either -o COPY, a tree to write, or --in-place");
    if (!changes && has_target)
        refuse(
            "-o and --in-place are for --save-attribute, --delete and --classify; --extract names its output itself");
    if (a.overwrite && a.extract.empty()) refuse("--overwrite is for --extract");
    if (a.brush.empty() != !a.radius) refuse("--brush X Y Z ... and --radius need each other");
    if (a.brush.size() % 3 != 0) refuse("--brush takes three numbers for each point of the stroke");
    const bool grows = a.grow || !a.grow_from.empty();
    if (grows != a.distance.has_value()) refuse("--distance, of a step, goes with --grow or --grow-from");
    if (a.grow && !a.grow_from.empty()) refuse("--grow and --grow-from cannot be combined");
    if (!a.brush.empty() && !a.grow_from.empty())
        refuse("--brush and --grow-from cannot be combined; --grow grows the brush");
    if (a.within && a.grow_from.empty()) refuse("--within, of the seed, goes with --grow-from");
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
    if (arguments.within) limit.clips.push_back({Region::sphere(seed.position, *arguments.within), false});
    PointSet seeds(tree);
    seeds.set(seed.node, {seed.index});
    if (!arguments.common.json)
        std::printf("grown from the point at %s, %s source units from the one given\n", exact(seed.position).c_str(),
                    brief(seed.distance()).c_str());
    PointSet set = grow(seeds, *arguments.distance, growth_of(arguments, std::move(limit)));
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

// What was done with the points.
struct Done {
    std::string what;  // "saved", ...; empty: nothing
    std::string output;
    std::uint64_t changed = 0;
    Outcome outcome;
    std::vector<std::string> notes;
};

Done change(const Arguments& arguments, const PointSet& set)
{
    SetChangeOptions options;
    options.target = arguments.target.get();
    options.memory_bytes = arguments.memory;
    options.threads = arguments.threads;
    options.progress = console_progress(arguments.common);
    Done done;
    if (arguments.erase) {
        SetErasure erased = delete_points(set, options);
        done = {"deleted", erased.tree.string(), erased.report.points_deleted, erased.report.outcome, {}};
        if (!erased.report.coverage_kept)
            done.notes.push_back("coarse levels have gaps where points were deleted; 'pcmlab compact' closes them");
        return done;
    }
    const bool classifies = arguments.classify.has_value();
    if (classifies &&
        !(std::fabs(*arguments.classify) < 1e15 && std::nearbyint(*arguments.classify) == *arguments.classify))
        throw Error(ErrorCode::invalid_argument, {}, "--classify " + exact(*arguments.classify) + " is no integer");
    const SetChangeReport report =
        classifies ? classify_points(set, static_cast<std::int64_t>(*arguments.classify), arguments.classes, options)
                   : save_as_attribute(set, arguments.attribute, options);
    return {classifies ? "classified" : "saved", report.tree.string(), report.outcome.points_out, report.outcome, {}};
}

Done act(const Arguments& arguments, const PointSet& set)
{
    if (arguments.extract.empty()) {
        if (arguments.attribute.empty() && !arguments.erase && !arguments.classify) return {};
        return change(arguments, set);
    }
    ExtractOptions options;
    options.overwrite = arguments.overwrite;
    options.threads = arguments.threads;
    options.memory_bytes = std::max(arguments.memory, std::uint64_t(256) << 20);
    options.progress = console_progress(arguments.common);
    const ConvertReport report = extract_points(set, arguments.extract, options);
    return {"extracted", arguments.extract, report.outcome.points_out, report.outcome, report.notes};
}

Json json_of(const Box3d& box) { return box.empty() ? Json() : Json({{"min", box.min}, {"max", box.max}}); }

void print(const Arguments& arguments, const PointSet& set, const SetStatistics& statistics, const Done& done,
           double seconds)
{
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
        json["done"] = done.what.empty() ? Json() : Json(done.what);
        json["output"] = done.output.empty() ? Json() : Json(done.output);
        json["points_changed"] = done.changed;
        json["seconds"] = seconds;
        json["peak_rss_bytes"] = peak_memory_bytes();
        json["notes"] = done.notes;
        json["warnings"] = done.outcome.warnings;
        std::printf("%s\n", json.dump(2).c_str());
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
    if (done.what == "saved" || done.what == "classified")
        std::printf("%s: %s values changed\n", done.output.c_str(), grouped(done.changed).c_str());
    else if (!done.what.empty())
        std::printf("%s: %s points %s\n", done.output.c_str(), grouped(done.changed).c_str(), done.what.c_str());
    for (const std::string& note : done.notes) std::printf("note: %s\n", note.c_str());
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
    const Done done = act(arguments, set);
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
    options.option("--radius", arguments.radius, "Of the brush, source units").not_negative().group(group);
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
            "--front", arguments.front,
            "Of a lasso (--region \"lasso ...\") only points that no others hide, in a view of so many pixels in width "
            "and height")
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
    const char* const group = "What to do with them (default: count them)";
    options
        .option("--save-attribute", arguments->attribute,
                "Write this attribute (u8): 1 for the selected points, 0 for all others; --where NAME=1 selects them "
                "again")
        .group(group);
    options.option("--extract", arguments->extract, "Write the points to this file, or tree (.pct)").group(group);
    options.flag("--overwrite", arguments->overwrite, "Replace the output of --extract if it exists").group(group);
    options.flag("--delete", arguments->erase, "Delete them").group(group);
    options.option("--classify", arguments->classify, "Set their class to this integer").group(group);
    options
        .option("--class-attribute", arguments->classes,
                "The integer attribute that --classify sets (default classification); made when absent")
        .group(group);
    arguments->target.add_to(options);
    options.option("-m,--memory", arguments->memory, "Memory for growing and writing, e.g. 512M (default 256M)")
        .bytes();
    options.option("-t,--threads", arguments->threads, "Threads (default: one per processor)");
    add_common(options, arguments->common);
    return [arguments] { return select(*arguments); };
}

}  // namespace pcm::cli
