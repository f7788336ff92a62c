// A tree is moved to another one by pairs of points.
#include "pcm/align/pair_text.h"
#include "pcm/align/pick_spacing.h"
#include "pcm/align/rigid_fit.h"
#include "pcm/cloud/vector.h"
#include "pcm/io/crs/coordinate_system.h"
#include "pcm/ops/shared/moved_cloud.h"
#include "pcm/ops/shared/result_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>

namespace pcm::ops {
namespace {

// What the clouds have at the picked places.
struct Picks {
    std::vector<double> spacings;  // spacings of the moving points, then of the fixed ones
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

std::string system_text_of(const Tree& tree)
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

struct Alignment {
    std::vector<PointPair> pairs;
    RigidFit fit;
    Picks picks;
    std::string moving_system, fixed_system;  // the second is empty without a fixed tree
    double largest_error = 0, pick_error = 0;
};

void put_pairs(Json& json, const Alignment& found)
{
    const std::size_t n = found.pairs.size();
    Json list = Json::array();
    for (std::size_t i = 0; i < n; ++i)
        list.push_back(
            {{"moving", found.pairs[i].moving},
             {"fixed", found.pairs[i].fixed},
             {"weight", found.pairs[i].weight},
             {"offset", found.fit.offsets[i]},
             {"residual", found.fit.residuals[i]},
             {"moving_spacing", found.picks.spacings[i]},
             {"fixed_spacing", n + i < found.picks.spacings.size() ? Json(found.picks.spacings[n + i]) : Json()}});
    json["pairs"] = std::move(list);
}

void put_fit(Json& json, const Alignment& found)
{
    const RigidFit& fit = found.fit;
    const Vec3d shift = shift_of_origin(fit.motion);
    Json rows = Json::array();
    for (std::size_t r = 0; r < 3; ++r)
        rows.push_back({fit.motion.linear[r][0], fit.motion.linear[r][1], fit.motion.linear[r][2], shift[r]});
    json["rms"] = fit.rms;
    json["scale"] = fit.scale;
    json["pairs_scale"] = fit.pairs_scale;
    json["axis"] = fit.axis;
    json["angle_degrees"] = fit.radians * 180 / pi;
    json["translation"] = fit.shift;
    json["pivot"] = fit.motion.pivot;
    json["target"] = fit.motion.target;
    json["matrix"] = rows;
    json["pick_error"] = found.pick_error;
    json["coordinate_error"] = fit.coordinate_error;
    json["angle_error_degrees"] = fit.angle_error * 180 / pi;
    json["weakest_axis"] = fit.weakest_axis;
    json["error_at_pairs"] = fit.error_at(fit.motion.pivot);
    json["error_of_cloud"] = found.largest_error;
}

class Align : public Operation {
public:
    Align()
    {
        arguments_.add("moving", moving_)
            .as(ValueKind::tree)
            .positional()
            .required()
            .script("Tree")
            .label("Tree folder")
            .help("Tree that is moved");
        arguments_.add("fixed", fixed_)
            .as(ValueKind::file)
            .positional()
            .label("Fixed tree")
            .help("Tree folder of the cloud that it is moved to: the places in it are looked at, too")
            .without("the pairs alone count");
        declare_pairs();
        arguments_.add("scale", options_.scale)
            .label("Fit a scale")
            .help("Fit a scale too, for clouds in different units; else rotation and translation only");
        arguments_.add("pick_error", pick_error_)
            .not_negative()
            .text_in_dialogs()
            .unit("source units")
            .label("Uncertainty of a pick")
            .help(
                "Standard deviation of a picked point. Pairs that lie no farther apart than a few times that are "
                "refused")
            .without("a quarter of the distance between the clouds' points there");
        arguments_.add("set_matrix", set_matrix_)
            .only(Face::dialog)  // the command has no layers
            .label("Set the layer's matrix")
            .help(
                "Only set the matrix of the current layer, which MeshLab keeps in single precision; no output folder "
                "is needed. Off: write a new tree, in double");
        to_.declare_output(arguments_).letter('o').without("only the motion is reported");
        to_.declare_work(arguments_);
    }

    Result answer(const Context& context) override
    {
        if (context.face == Face::dialog && to_.output.empty() && !set_matrix_)
            throw ArgumentError("no output folder is given: name the tree to write by " + called(context, "output") +
                                ", or set the layer's matrix");
        Alignment found;
        found.pairs = pairs_of(context);
        const auto moving = PointCloud::open(moving_);
        const auto fixed = fixed_.empty() ? nullptr : PointCloud::open(fixed_);
        refuse_output(moving->tree()->folder());
        if (fixed) refuse_output(fixed->tree()->folder());
        align(found, *moving, fixed.get());
        Result result;
        result.input = {moving_};
        if (fixed) result.input.push_back(fixed_);
        write(result, context, found);
        std::optional<BuildReport> report;
        if (set_matrix_ && context.set_matrix) {
            result.line(context.set_matrix(moving->tree()->folder(), found.fit.motion,
                                           "align by " + std::to_string(found.pairs.size()) + " pairs"));
        } else if (!to_.output.empty()) {
            BuildOptions options = to_.build_options(context);
            options.sampling = moving->info().sampling;
            report = write_moved(moving->tree(), {found.fit.motion}, to_.output, options);
        }
        put_moved(result, to_.output, report);
        result.accuracy = from_deviation(found.largest_error, "source units", "the moved cloud's places");
        if (!report && context.face == Face::command)
            result.line("nothing was written; -o NAME.pct writes the moved cloud");
        return result;
    }

private:
    void declare_pairs()
    {
        arguments_.add("pair", numbers_)
            .only(Face::command)  // dialogs have the text below, which has weights too
            .count(6, 6000)
            .label("Pair")
            .help(
                "A point of the moving cloud and the same place in the fixed one: x y z x y z, source coordinates; "
                "give three or more: --pair 1 2 3 11 2 3");
        arguments_.add("pairs_text", text_)
            .only(Face::dialog)  // a pair an option on the command line
            .script("Pairs")
            .label("Pairs")
            .help(
                "Three or more pairs of points, separated by semicolons: x y z in the tree that is moved, x y z of "
                "the same place in the other cloud, source coordinates; then, optionally, a weight")
            .without("those of the file");
        arguments_.add("pairs", file_)
            .as(ValueKind::file)
            .script("PairsFile")
            .label("File of pairs")
            .help(
                "A text file of pairs, one a line: x y z x y z and optionally a weight; # begins a comment. The tool "
                "Align by Picked Pairs saves such files")
            .without("no file");
    }

    std::vector<PointPair> pairs_of(const Context& context) const
    {
        if (context.face == Face::command && file_.empty() && numbers_.empty())
            throw ArgumentError("no pairs were given: name a file by --pairs, or give three or more --pair");
        if (numbers_.size() % 6 != 0) throw ArgumentError("--pair takes six numbers");
        std::string lines = text_;  // a pair a line, as in files
        std::replace(lines.begin(), lines.end(), ';', '\n');
        std::vector<PointPair> pairs = parse_pairs(lines, "Pairs");
        if (!file_.empty())
            for (const PointPair& pair : read_pairs(file_)) pairs.push_back(pair);
        const auto& v = numbers_;
        for (std::size_t i = 0; i + 6 <= v.size(); i += 6)
            pairs.push_back({{v[i], v[i + 1], v[i + 2]}, {v[i + 3], v[i + 4], v[i + 5]}, 1});
        return pairs;
    }

    void refuse_output(const std::filesystem::path& tree) const
    {
        std::error_code ignored;
        if (!to_.output.empty() && std::filesystem::equivalent(tree, to_.output, ignored))
            throw Error(ErrorCode::invalid_argument, to_.output, "the output is one of the two trees",
                        "give the new tree another name");
    }

    void align(Alignment& found, PointCloud& moving, PointCloud* fixed)
    {
        fit_motion(found.pairs);  // what is wrong with the numbers alone is reported before the clouds are read
        look_at(moving, "moving", found.pairs, &PointPair::moving, found.picks);
        if (fixed) look_at(*fixed, "fixed", found.pairs, &PointPair::fixed, found.picks);
        options_.pick_error = found.pick_error = pick_error_ ? *pick_error_ : pick_error_of(found.picks.spacings);
        found.fit = fit_motion(found.pairs, options_);
        found.largest_error = found.fit.largest_error(moving.info().bounds());
        found.moving_system = system_text_of(*moving.tree());
        if (fixed) found.fixed_system = system_text_of(*fixed->tree());
    }

    // Small residuals of few pairs say that these agree, not that the picked points are the places that were meant.
    std::string source_of_uncertainty(const Context& context, const Alignment& found) const
    {
        const std::string of_picks = brief(found.pick_error);
        // The larger of the two counts (RigidFit::coordinate_error).
        const bool from_residuals = found.fit.coordinate_error > std::sqrt(2.0) * found.pick_error * (1 + 1e-12);
        if (from_residuals || found.pick_error == 0) return "the uncertainty follows from the residuals of the pairs";
        const std::string option = called(context, "pick_error");
        if (pick_error_) return "the uncertainty follows from " + option + " " + of_picks + ", not from the residuals";
        return "the uncertainty follows from the spacing of the clouds' points, not from the residuals: a place is "
               "picked to a quarter of it, here " +
               of_picks + "; " + option + " says how well these were";
    }

    void write(Result& result, const Context& context, const Alignment& found) const
    {
        put_pairs(result.values, found);
        put_fit(result.values, found);
        result.values["moving_crs"] = found.moving_system;
        result.values["fixed_crs"] = fixed_.empty() ? Json() : Json(found.fixed_system);
        result.notes = found.picks.warnings;
        const RigidFit& fit = found.fit;
        for (std::size_t i = 0; i < fit.residuals.size(); ++i)
            result.line("pair " + std::to_string(i + 1) + ": residual " + brief(fit.residuals[i]) + " (" +
                        brief(fit.offsets[i][0]) + " " + brief(fit.offsets[i][1]) + " " + brief(fit.offsets[i][2]) +
                        ")");
        result.line("RMS of the residuals: " + brief(fit.rms) + " source units");
        result.line("rotation: " + exact(fit.radians * 180 / pi) + " degrees about " + exact(fit.axis) +
                    ", uncertain by " + brief(fit.angle_error * 180 / pi) + " degrees");
        result.line("translation of the pairs' centroid " + exact(fit.motion.pivot) + ": " + exact(fit.shift));
        result.line(options_.scale ? "scale: " + exact(fit.scale)
                                   : "scale: 1 (the pairs suggest " + exact(fit.pairs_scale) + "; " +
                                         called(context, "scale") + " applies it)");
        const Vec3d shift = shift_of_origin(fit.motion);
        for (std::size_t r = 0; r < 3; ++r)
            result.line("matrix: " + exact(fit.motion.linear[r]) + " " + exact(shift[r]));
        result.line("uncertainty of the moved cloud: " + brief(fit.error_at(fit.motion.pivot)) +
                    " at the pairs' centroid, up to " + brief(found.largest_error) +
                    " at its corners (one standard deviation, source units)");
        result.line(source_of_uncertainty(context, found));
        if (!fixed_.empty() && found.moving_system != found.fixed_system)
            result.notes.push_back("the moved cloud is in the coordinates of " + fixed_ + " (" + found.fixed_system +
                                   "); its metadata stay those of " + moving_ + " (" + found.moving_system + ")");
    }

    std::string moving_, fixed_, file_, text_;
    std::vector<double> numbers_;
    std::optional<double> pick_error_;
    bool set_matrix_ = false;
    FitOptions options_;
    NewCloudArguments to_;
};

}  // namespace

Row align_row()
{
    return {"align",
            "Align Point Clouds by Pairs",
            "Move a tree to another one by pairs of points, and report how well they agree",
            "Moves a <b>point cloud tree</b> to another cloud by three or more pairs of points: the rotation and "
            "translation (optionally the scale) with the least squares of the residuals, which are reported with their "
            "uncertainty. The pairs' source coordinates count; a matrix that the layer has is replaced. Writes a new "
            "tree, or sets the matrix of the current layer. The tool <i>Align by Picked Pairs</i> picks the pairs in "
            "the view.",
            menu::points | menu::layers,
            "-aligned.pct",
            {{"pairs", "list", "", "moving, fixed, weight, offset, residual, moving_spacing, fixed_spacing"},
             {"rms", "number", "source units", "root mean square of the residuals"},
             {"scale", "number", "", "scale of the motion"},
             {"pairs_scale", "number", "", "scale that the pairs suggest"},
             {"axis", "list", "", "axis of the rotation"},
             {"angle_degrees", "number", "degrees", "angle of the rotation"},
             {"translation", "list", "source units", "translation of the pairs' centroid"},
             {"pivot", "list", "source units", "centroid of the moving points"},
             {"target", "list", "source units", "where the pivot is moved to"},
             {"matrix", "list", "", "rows of the 3 x 4 matrix"},
             {"pick_error", "number", "source units", "standard deviation of a picked point"},
             {"coordinate_error", "number", "source units", "standard deviation of a residual's coordinate"},
             {"angle_error_degrees", "number", "degrees", "uncertainty of the rotation about its weakest axis"},
             {"weakest_axis", "list", "", "axis about which the rotation is the least certain"},
             {"error_at_pairs", "number", "source units", "uncertainty of the moved cloud at the pairs' centroid"},
             {"error_of_cloud", "number", "source units", "the same at the corners of its box"},
             {"moving_crs", "text", "", "coordinate system of the moving tree"},
             {"fixed_crs", "text?", "", "coordinate system of the fixed tree; null: none was named"},
             {"position_error", "number?", "source units", "largest position error; null: nothing was written"},
             {"bytes", "count?", "bytes", "size of the result; null: nothing was written"}},
            make<Align>,
            {},
            "It takes neither a time limit nor an error target: the error follows from the pairs, and more of them "
            "make it smaller."};
}

}  // namespace pcm::ops
