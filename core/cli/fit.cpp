#include "pcm/cli/common.h"
#include "pcm/cli/primitive_output.h"
#include "pcm/cli/region_options.h"
#include "pcm/cli/set_actions.h"
#include "pcm/fit/pcl_fit.h"
#include "pcm/place/fit_at.h"
#include "pcm/point_cloud.h"
#include "pcm/system/error.h"
#include "pcm/system/peak_memory.h"

#include <chrono>
#include <cstdio>
#include <memory>
#include <sstream>
#include <utility>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree;
    std::vector<std::string> at, not_at;
    std::string shape = "any", estimator = "msac", backend = "own", outline = "concave";
    std::optional<double> threshold, seconds, radius, step, normal_angle, least_radius, largest_radius, outline_edge;
    std::optional<std::uint64_t> count;
    double probability = 0.99;
    std::uint32_t iterations = 10000, rounds = 8;
    std::uint64_t seed = 1;
    bool grow = true;
    RegionOptions region;
    std::string list, name;
    SetActions actions;
    std::uint64_t memory = std::uint64_t(256) << 20;
    std::uint32_t threads = 0;
};

// Places as "X Y Z", X Y Z or X,Y,Z.
std::vector<Vec3d> places_of(const std::vector<std::string>& words, const char* option)
{
    std::vector<double> numbers;
    for (std::string text : words) {
        for (char& c : text)
            if (c == ',') c = ' ';
        std::istringstream stream(text);
        stream.imbue(std::locale::classic());
        for (double number = 0; stream >> number;) numbers.push_back(number);
        if (!stream.eof()) throw UsageError(std::string(option) + ": '" + text + "' is not made of numbers");
    }
    if (numbers.size() % 3 != 0)
        throw UsageError(std::string(option) + " takes three numbers for each place: \"X Y Z\"");
    std::vector<Vec3d> places;
    for (std::size_t i = 0; i < numbers.size(); i += 3) places.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
    return places;
}

void check(const Arguments& a)
{
    a.actions.check(a.tree);
    if (a.radius && a.count) throw UsageError("--radius and --count, of the neighbourhood, cannot be combined");
    if (!a.grow && a.step) throw UsageError("--step is for growth; --no-grow was given");
    if (a.outline_edge && a.outline != "concave") throw UsageError("--outline-edge is for --outline concave");
    if (!a.name.empty() && a.list.empty()) throw UsageError("--name is for --add");
}

FitAtOptions options_of(const Arguments& a)
{
    FitAtOptions options;
    if (const auto kind = shape_kind(a.shape))
        options.fit.kind = *kind;
    else
        for (const ShapeTraits& row : shape_kinds()) options.kinds.push_back(row.kind);
    options.fit.estimator = *estimator_of(a.estimator);
    options.fit.backend = a.backend == "pcl" ? FitBackend::pcl : FitBackend::own;
    options.fit.threshold = a.threshold.value_or(0);
    options.fit.iterations = a.iterations;
    options.fit.probability = a.probability;
    options.fit.seconds = a.seconds.value_or(0);
    options.fit.seed = a.seed;
    options.fit.least_radius = a.least_radius.value_or(options.fit.least_radius);
    options.fit.largest_radius = a.largest_radius.value_or(options.fit.largest_radius);
    if (a.normal_angle) options.fit.normal_angle = options.turned_angle = *a.normal_angle * pi / 180;
    options.radius = a.radius.value_or(0);
    options.count = a.count.value_or(0);
    options.grow = a.grow;
    options.step = a.step.value_or(0);
    options.rounds = a.rounds;
    options.limit = a.region.get();
    options.outline.kind = *outline_kind(a.outline);
    options.outline.edge = a.outline_edge.value_or(0);
    options.threads = a.threads;
    options.memory_bytes = a.memory;
    options.progress = console_progress(a.common);
    return options;
}

void report_json(const Arguments& arguments, const FittedPrimitive& fitted, const SetDone& done, double seconds)
{
    Json json;
    json["tree"] = arguments.tree;
    json["primitive"] = json_of(fitted.primitive);
    json["points"] = fitted.points.size();
    json["neighbourhood"] = {{"points", fitted.near.ids.size()},
                             {"found", fitted.near.found},
                             {"radius", fitted.near.radius},
                             {"spacing", fitted.near.spacing},
                             {"inliers", fitted.local.inliers}};
    json["growth"] = Json();
    if (fitted.rounds > 0)
        json["growth"] = {{"step", fitted.step},
                          {"rounds", fitted.rounds},
                          {"converged", fitted.converged},
                          {"left_surface", fitted.left_surface.empty() ? Json() : Json(fitted.left_surface)}};
    json["list"] = arguments.list.empty() ? Json() : Json(arguments.list);
    put_done(json, done);
    json["seconds"] = seconds;
    json["peak_rss_bytes"] = peak_memory_bytes();
    std::vector<std::string> notes = fitted.notes;
    notes.insert(notes.end(), done.notes.begin(), done.notes.end());
    json["notes"] = notes;
    json["warnings"] = done.outcome.warnings;
    print_json(json);
}

void print_text(const Arguments& arguments, const FittedPrimitive& fitted, const SetDone& done, double seconds)
{
    print_primitive(fitted.primitive);
    if (fitted.primitive.fit.has_shape()) {
        std::printf("%s: %s points belong to it; fitted to %s of %s points around the place%s\n",
                    arguments.tree.c_str(), grouped(fitted.points.size()).c_str(),
                    grouped(fitted.local.inliers).c_str(), grouped(fitted.near.ids.size()).c_str(),
                    fitted.rounds == 0             ? ""
                    : !fitted.left_surface.empty() ? ", and not followed: growth left the surface"
                                                   : (", grown by steps of " + brief(fitted.step)).c_str());
        if (fitted.rounds > 0 && !fitted.converged && fitted.left_surface.empty())
            std::printf("note: the shape still changed in the last of %u rounds of growth\n", fitted.rounds);
    }
    if (!arguments.list.empty() && fitted.primitive.fit.has_shape())
        std::printf("%s: %s added%s\n", arguments.list.c_str(), fitted.primitive.name.c_str(),
                    fitted.primitive.fit.verdict == FitVerdict::doubtful ? ", as doubtful" : "");
    print_done(done);
    for (const std::string& note : fitted.notes) std::printf("note: %s\n", note.c_str());
    for (const std::string& note : done.notes) std::printf("note: %s\n", note.c_str());
    std::printf("%.2f s, peak memory %s\n", seconds, bytes_text(peak_memory_bytes()).c_str());
}

// When the primitive is in the list, a failure is no reason to repeat all of the command: it would be there twice.
SetDone do_with_points(const Arguments& arguments, const FittedPrimitive& fitted)
{
    try {
        return arguments.actions.run(fitted.points, arguments.common, arguments.memory, arguments.threads);
    } catch (const Error& error) {
        if (arguments.list.empty()) throw;
        throw Error::after(arguments.list, fitted.primitive.name + " was added", error);
    }
}

int fit(const Arguments& arguments)
{
    const auto start = std::chrono::steady_clock::now();
    check(arguments);
    const FitAtOptions options = options_of(arguments);
    if (!arguments.list.empty()) check_list(arguments.list);
    const auto cloud = PointCloud::open(arguments.tree);
    FittedPrimitive fitted =
        fit_at(*cloud, places_of(arguments.at, "--at"), places_of(arguments.not_at, "--not-at"), options);
    fitted.primitive.name = arguments.name.empty() && arguments.list.empty()
                                ? traits_of(fitted.primitive.fit.shape.kind).label
                                : arguments.name;
    SetDone done;
    if (fitted.primitive.fit.has_shape()) {
        Outcome listed;  // its warnings
        // The list first: points that are deleted cannot be fitted again.
        if (!arguments.list.empty()) run_last_step(listed, [&] { add_to_list(arguments.list, fitted.primitive); });
        done = do_with_points(arguments, fitted);
        done.outcome.warnings.insert(done.outcome.warnings.begin(), listed.warnings.begin(), listed.warnings.end());
    }
    end_progress(arguments.common);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (arguments.common.json)
        report_json(arguments, fitted, done, seconds);
    else
        print_text(arguments, fitted, done, seconds);
    return fitted.primitive.fit.has_shape() ? finished(done.outcome) : 1;
}

std::vector<std::string> names_of_shapes()
{
    std::vector<std::string> names{"any"};
    for (const ShapeTraits& row : shape_kinds()) names.push_back(row.name);
    return names;
}

std::vector<std::string> names_of_estimators()
{
    std::vector<std::string> names;
    for (const EstimatorTraits& row : estimators()) names.push_back(row.name);
    return names;
}

void add_shape(Options& options, Arguments& a)
{
    const char* const group = "Shape";
    options.option("--at", a.at, "A place \"X Y Z\" on the surface, source coordinates; more of them refine the fit")
        .required()
        .values(1, 3000)
        .group(group);
    options
        .option("--not-at", a.not_at,
                "A place \"X Y Z\" that is not part of it: points around it are ignored and not reached")
        .values(1, 3000)
        .group(group);
    options
        .option("--shape", a.shape,
                "What to fit (default any: each kind is fitted, and the one that explains the points best, with the "
                "fewest parameters, is kept)")
        .one_of(names_of_shapes())
        .group(group);
    options.option("--radius", a.radius, "Neighbourhood of a place: all points so near, source units")
        .positive()
        .group(group);
    options
        .option("--count", a.count,
                "Neighbourhood of a place: its nearest points (default 500, and more while the fit is not good)")
        .positive()
        .group(group);
    options.option("--least-radius", a.least_radius, "Smaller radii are not considered, source units")
        .not_negative()
        .group(group);
    options.option("--largest-radius", a.largest_radius, "Larger radii are not considered, source units")
        .positive()
        .group(group);
}

void add_estimator(Options& options, Arguments& a)
{
    const char* const group = "Estimator";
    options.option("--estimator", a.estimator, "How samples are drawn and scored (default msac)")
        .one_of(names_of_estimators())
        .group(group);
    options
        .option("--threshold", a.threshold,
                "Largest distance of a point from the surface, source units (default: from the noise of the points)")
        .positive()
        .group(group);
    options
        .option(
            "--normal-angle", a.normal_angle,
            "Largest angle between the shape and the surface of the points around a point, degrees: growth does not "
            "pass where it is larger (default 30, computed from the points, and with --threshold not compared; 90: not "
            "compared). Where it is given and the cloud has normals, these are compared, too")
        .positive()
        .group(group);
    options.option("--iterations", a.iterations, "Maximum number of samples (default 10000)").group(group);
    options
        .option("--probability", a.probability,
                "Probability, below 1, that a sample without outliers was drawn, which ends the search (default 0.99)")
        .group(group);
    options.option("--seconds", a.seconds, "Time limit of the search for samples (default: none)")
        .positive()
        .group(group);
    options.option("--seed", a.seed, "Start of the random numbers that draw the samples (default 1)").group(group);
    options.option("--backend", a.backend, "own, or pcl: the Point Cloud Library, for comparison (default own)")
        .one_of({"own", "pcl"})
        .group(group)
        .shown_if(has_pcl());
}

void add_growth(Options& options, Arguments& a)
{
    const char* group = "Growth over the cloud";
    options.off_flag("--no-grow", a.grow, "Only points of the neighbourhood belong to the shape").group(group);
    options.option("--step", a.step, "Maximum distance from point to point, source units (default: from the gaps)")
        .positive()
        .group(group);
    options
        .option("--rounds", a.rounds,
                "Maximum number of rounds of growing and fitting to all points reached (default 8; 0: the shape of the "
                "first fit)")
        .between(0, 100)
        .group(group);
    options
        .option(
            "--outline", a.outline,
            "Of a plane, and what its area is of: concave (default), which follows the points' edge and gaps, convex, "
            "rectangle, the least around the points, or box, where the cloud's box cuts it")
        .one_of({"box", "rectangle", "convex", "concave"})
        .group(group);
    options
        .option("--outline-edge", a.outline_edge,
                "Of a concave outline: narrower gaps are closed, source units (default: from the spacing)")
        .positive()
        .group(group);
    a.region.add_to(options, "Points to look at (default: all)");
}

}  // namespace

Run add_fit(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "Tree folder, or any file of it").required();
    add_shape(options, *arguments);
    add_estimator(options, *arguments);
    add_growth(options, *arguments);
    const char* const group = "What to do with the shape";
    options
        .option("--add", arguments->list,
                "Add it to this list of primitives (.json), which is made when absent; 'pcmlab primitives' exports it")
        .group(group);
    options.option("--name", arguments->name, "Its name in the list (default: its kind and a number)").group(group);
    arguments->actions.add_to(options, "What to do with its points (default: count them)");
    options.option("-m,--memory", arguments->memory, "Memory for growing and writing, e.g. 512M (default 256M)")
        .bytes();
    options.option("-t,--threads", arguments->threads, "Threads (default: one per processor)");
    add_common(options, arguments->common);
    return [arguments] { return fit(*arguments); };
}

}  // namespace pcm::cli
