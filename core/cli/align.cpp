#include "pcm/align/pair_text.h"
#include "pcm/align/pick_spacing.h"
#include "pcm/align/rigid_fit.h"
#include "pcm/build/builder.h"
#include "pcm/cli/common.h"
#include "pcm/cloud/vector.h"
#include "pcm/filter/result_tree.h"
#include "pcm/io/crs/coordinate_system.h"
#include "pcm/io/pipe/transformed_reader.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string moving, fixed, pairs_file, output;
    std::vector<double> pairs;
    bool scale = false;
    std::optional<double> pick_error;
    std::uint64_t memory = std::uint64_t(1) << 30;
    BuildOptions options;
};

std::vector<PointPair> pairs_of(const Arguments& arguments)
{
    std::vector<PointPair> pairs;
    if (!arguments.pairs_file.empty()) pairs = read_pairs(arguments.pairs_file);
    const auto& v = arguments.pairs;
    for (std::size_t i = 0; i + 6 <= v.size(); i += 6)
        pairs.push_back({{v[i], v[i + 1], v[i + 2]}, {v[i + 3], v[i + 4], v[i + 5]}, 1});
    return pairs;
}

// What the clouds have at the picked places.
struct Picks {
    std::vector<double> spacings;  // of the moving points, then of the fixed ones
    std::vector<std::string> warnings;
};

void look_at(PointCloud& cloud, const char* name, const std::vector<PointPair>& pairs, Vec3d PointPair::*of,
             Picks& picks)
{
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const PickSpacing found = spacing_at(cloud, pairs[i].*of);
        picks.spacings.push_back(found.spacing);
        if (found.distance > 2 * found.spacing)
            picks.warnings.push_back("pair " + std::to_string(i + 1) + ": the nearest point of the " + name +
                                     " cloud is " + brief(found.distance) + " away, where its points are " +
                                     brief(found.spacing) + " apart");
    }
}

std::string system_of(const Tree& tree)
{
    const auto system = coordinate_system_of(tree.info().metadata);
    return system ? describe(*system) : "none stated";
}

Vec3d shift_of_origin(const Affine& map)
{
    Vec3d shift;
    for (std::size_t r = 0; r < 3; ++r) {
        long double sum = map.target[r];
        for (std::size_t c = 0; c < 3; ++c) sum -= static_cast<long double>(map.linear[r][c]) * map.pivot[c];
        shift[r] = static_cast<double>(sum);
    }
    return shift;
}

struct Result {
    RigidFit fit;
    Picks picks;
    std::string moving_system, fixed_system;
    double largest_error = 0, pick_error = 0;
    std::optional<BuildReport> build;
};

Json json_of(const Arguments& arguments, const std::vector<PointPair>& pairs, const Result& result)
{
    const RigidFit& fit = result.fit;
    const Vec3d shift = shift_of_origin(fit.motion);
    Json rows = Json::array(), list = Json::array();
    for (std::size_t r = 0; r < 3; ++r)
        rows.push_back({fit.motion.linear[r][0], fit.motion.linear[r][1], fit.motion.linear[r][2], shift[r]});
    const std::size_t n = pairs.size();
    for (std::size_t i = 0; i < n; ++i)
        list.push_back({{"moving", pairs[i].moving},
                        {"fixed", pairs[i].fixed},
                        {"weight", pairs[i].weight},
                        {"offset", fit.offsets[i]},
                        {"residual", fit.residuals[i]},
                        {"moving_spacing", result.picks.spacings[i]},
                        {"fixed_spacing", result.picks.spacings[n + i]}});
    Json json;
    json["moving"] = arguments.moving;
    json["fixed"] = arguments.fixed;
    json["output"] = arguments.output.empty() ? Json() : Json(arguments.output);
    json["pairs"] = list;
    json["rms"] = fit.rms;
    json["scale"] = fit.scale;
    json["pairs_scale"] = fit.pairs_scale;
    json["axis"] = fit.axis;
    json["angle_degrees"] = fit.radians * 180 / pi;
    json["translation"] = fit.shift;
    json["pivot"] = fit.motion.pivot;
    json["target"] = fit.motion.target;
    json["matrix"] = rows;
    json["pick_error"] = result.pick_error;
    json["coordinate_error"] = fit.coordinate_error;
    json["angle_error_degrees"] = fit.angle_error * 180 / pi;
    json["weakest_axis"] = fit.weakest_axis;
    json["error_at_pairs"] = fit.error_at(fit.motion.pivot);
    json["error_of_cloud"] = result.largest_error;
    json["moving_crs"] = result.moving_system;
    json["fixed_crs"] = result.fixed_system;
    json["notes"] = result.picks.warnings;
    if (result.build) {
        put_outcome(json, result.build->outcome);
        json["position_error"] = result.build->outcome.error;
        json["bytes"] = result.build->bytes;
    }
    return json;
}

// Small residuals of few pairs say that these agree, not that the picked points are the places that were meant.
std::string source_of_uncertainty(const Arguments& arguments, const Result& result)
{
    const std::string of_picks = brief(result.pick_error);
    // The larger of the two counts (RigidFit::coordinate_error).
    const bool from_residuals = result.fit.coordinate_error > std::sqrt(2.0) * result.pick_error * (1 + 1e-12);
    if (from_residuals || result.pick_error == 0) return "the uncertainty follows from the residuals of the pairs";
    if (arguments.pick_error)
        return "the uncertainty follows from --pick-error " + of_picks + ", not from the residuals";
    return "the uncertainty follows from the spacing of the clouds' points, not from the residuals: a place is picked "
           "to a quarter of it, here " +
           of_picks + "; --pick-error says how well these were";
}

void print(const Arguments& arguments, const Result& result)
{
    const RigidFit& fit = result.fit;
    for (const std::string& warning : result.picks.warnings) std::printf("note: %s\n", warning.c_str());
    for (std::size_t i = 0; i < fit.residuals.size(); ++i)
        std::printf(
            "pair %zu: residual %s (%s)\n", i + 1, brief(fit.residuals[i]).c_str(),
            (brief(fit.offsets[i][0]) + " " + brief(fit.offsets[i][1]) + " " + brief(fit.offsets[i][2])).c_str());
    std::printf("RMS of the residuals: %s source units\n", brief(fit.rms).c_str());
    std::printf("rotation: %s degrees about %s, uncertain by %s degrees\n", exact(fit.radians * 180 / pi).c_str(),
                exact(fit.axis).c_str(), brief(fit.angle_error * 180 / pi).c_str());
    std::printf("translation of the pairs' centroid %s: %s\n", exact(fit.motion.pivot).c_str(),
                exact(fit.shift).c_str());
    if (arguments.scale)
        std::printf("scale: %s\n", exact(fit.scale).c_str());
    else
        std::printf("scale: 1 (the pairs suggest %s; --scale applies it)\n", exact(fit.pairs_scale).c_str());
    const Vec3d shift = shift_of_origin(fit.motion);
    for (std::size_t r = 0; r < 3; ++r)
        std::printf("matrix: %s %s\n", exact(fit.motion.linear[r]).c_str(), exact(shift[r]).c_str());
    std::printf(
        "uncertainty of the moved cloud: %s at the pairs' centroid, up to %s at its corners (one standard "
        "deviation, source units)\n",
        brief(fit.error_at(fit.motion.pivot)).c_str(), brief(result.largest_error).c_str());
    std::printf("%s\n", source_of_uncertainty(arguments, result).c_str());
    if (result.moving_system != result.fixed_system)
        std::printf("note: the moved cloud is in the coordinates of %s (%s); its metadata stay those of %s (%s)\n",
                    arguments.fixed.c_str(), result.fixed_system.c_str(), arguments.moving.c_str(),
                    result.moving_system.c_str());
    if (!result.build) {
        std::printf("nothing was written; -o NAME.pct writes the moved cloud\n");
        return;
    }
    for (const std::string& note : result.build->notes) std::printf("note: %s\n", note.c_str());
    std::printf("%s: %s points in %.1f s, %s; largest position error %s source units\n", arguments.output.c_str(),
                grouped(result.build->outcome.points_out).c_str(), result.build->outcome.seconds,
                bytes_text(result.build->bytes).c_str(), exact(result.build->outcome.error).c_str());
}

BuildReport write_moved(Arguments& arguments, const std::shared_ptr<const Tree>& tree, const Affine& motion)
{
    const auto open = [&] {
        return std::make_unique<TransformedReader>(std::make_unique<TreeReader>(tree, std::nullopt, Selection()),
                                                   motion);
    };
    arguments.options.memory_bytes = arguments.memory;
    arguments.options.sampling = tree->info().sampling;
    arguments.options.progress = console_progress(arguments.common);
    BuildReport report = build_or_write(open, tree->info().sources, arguments.output, arguments.options);
    end_progress(arguments.common);
    return report;
}

int align(Arguments& arguments)
{
    if (arguments.pairs_file.empty() && arguments.pairs.empty())
        throw UsageError("no pairs were given: name a file by --pairs, or give three or more --pair");
    if (arguments.pairs.size() % 6 != 0) throw UsageError("--pair takes six numbers");
    const auto pairs = pairs_of(arguments);
    const auto moving = PointCloud::open(arguments.moving), fixed = PointCloud::open(arguments.fixed);
    if (!arguments.output.empty())
        for (const auto* tree : {moving->tree().get(), fixed->tree().get()}) {
            std::error_code ignored;
            if (std::filesystem::equivalent(tree->folder(), arguments.output, ignored))
                throw Error(ErrorCode::invalid_argument, arguments.output, "the output is one of the two trees",
                            "give the new tree another name");
        }
    Result result;
    fit_motion(pairs);  // what is wrong with the numbers alone is said before the clouds are read
    look_at(*moving, "moving", pairs, &PointPair::moving, result.picks);
    look_at(*fixed, "fixed", pairs, &PointPair::fixed, result.picks);
    FitOptions options;
    options.scale = arguments.scale;
    options.pick_error = result.pick_error =
        arguments.pick_error ? *arguments.pick_error : pick_error_of(result.picks.spacings);
    result.fit = fit_motion(pairs, options);
    result.largest_error = result.fit.largest_error(moving->info().bounds());
    result.moving_system = system_of(*moving->tree());
    result.fixed_system = system_of(*fixed->tree());
    if (!arguments.output.empty()) result.build = write_moved(arguments, moving->tree(), result.fit.motion);
    if (arguments.common.json)
        print_json(json_of(arguments, pairs, result));
    else
        print(arguments, result);
    return result.build ? finished(result.build->outcome) : 0;
}

}  // namespace

Run add_align(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("moving", arguments->moving, "Tree that is moved").required();
    options.positional("fixed", arguments->fixed, "Tree that it is moved to").required();
    options
        .option("--pair", arguments->pairs,
                "A point of the moving cloud and the same place in the fixed one: x y z x y z, source coordinates; "
                "give three or more: --pair 1 2 3 11 2 3")
        .values(6, 6000);
    options.option("--pairs", arguments->pairs_file,
                   "A text file of pairs, one a line: x y z x y z and optionally a weight; # begins a comment");
    options.flag("--scale", arguments->scale, "Fit a scale too (default: rotation and translation only)");
    options
        .option("--pick-error", arguments->pick_error,
                "Standard deviation of a picked point, source units (default: a quarter of the distance between the "
                "clouds' points there)")
        .not_negative();
    options.option(
        "-o,--output", arguments->output,
        "The moved cloud as a new tree, by convention NAME.pct, or as a file, by the extension (default: only the "
        "motion is reported)");
    options.option("-m,--memory", arguments->memory, "Memory limit of the build, e.g. 512M or 2G (default 1G)").bytes();
    options.option("--chunk-points", arguments->options.chunk_points,
                   "Maximum number of points per chunk (default 25000)");
    options.option("-t,--threads", arguments->options.threads, "Threads (default: one per processor)");
    options.flag("--overwrite", arguments->options.overwrite, "Replace an existing tree of the output's name");
    add_common(options, arguments->common);
    return [arguments] { return align(*arguments); };
}

}  // namespace pcm::cli
