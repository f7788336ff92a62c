// A shape at given places of a cloud, followed through it.
#include "pcm/fit/pcl_fit.h"
#include "pcm/ops/shared/drawing_arguments.h"
#include "pcm/ops/shared/measure_report.h"
#include "pcm/ops/shared/point_set_actions.h"
#include "pcm/ops/shared/primitive_report.h"
#include "pcm/ops/shared/region_arguments.h"
#include "pcm/ops/shared/window_arguments.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/place/fit_at.h"
#include "pcm/point_cloud.h"
#include "pcm/system/counted.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <utility>

namespace pcm::ops {
namespace {

std::vector<Choice> shape_choices()
{
    std::vector<Choice> all{{"any", "Any"}};
    for (const ShapeTraits& row : shape_kinds()) all.push_back({row.name, row.label});
    return all;
}

std::vector<Choice> estimator_choices()
{
    std::vector<Choice> all;
    for (const EstimatorTraits& row : estimators()) all.push_back({row.name, row.label});
    return all;
}

// A plane's place is uncertain along its normal, an axis across itself, a centre or an apex in all directions.
Accuracy accuracy_of_fit(const ShapeFit& fit)
{
    const ShapeKind kind = fit.shape.kind;
    const std::size_t dimensions = kind == ShapeKind::plane ? 1 : kind == ShapeKind::cylinder ? 2 : 3;
    return from_deviation(fit.errors.position, "source units", "the shape's place", dimensions);
}

class Fit : public Operation {
public:
    Fit()
    {
        arguments_.add("tree", tree_)
            .as(ValueKind::tree)
            .positional()
            .required()
            .label("Tree folder")
            .help("Tree folder, or any file of it");
        declare_shape();
        declare_estimator();
        declare_limit();
        declare_registration();
        declare_growth();
        region_.declare(arguments_, "Points to look at (default: all)");
        clip_.declare(arguments_);
        const char* const group = "What to do with the shape";
        arguments_.add("add", list_)
            .as(ValueKind::output)
            .only(Face::command)  // a window adds it to the list of the project
            .group(group)
            .help(
                "Add it to this list of primitives (.json), which is made when absent; 'pcmlab primitives' exports it");
        arguments_.add("name", name_)
            .group(group)
            .label("Name")
            .help("Its name in the list")
            .without("its kind and a number");
        arguments_.add("out", out_)
            .as(ValueKind::output)
            .script("OutputFile")
            .group(group)
            .label("Output file")
            .help("File to write the shape to, in source coordinates: " + drawing_formats() + ", as its name ends")
            .without("no file");
        drawing_.declare(arguments_);
        actions_.declare(arguments_, "What to do with its points (default: count them)");
        work_.declare(arguments_, options_.memory_bytes, "growing and writing");
    }

    Result answer(const Context& context) override
    {
        check(context);
        set_options(context);
        if (!list_.empty()) check_list(list_);
        const auto cloud = context.open(tree_);
        FittedPrimitive fitted =
            fit_at(*cloud, points_of(at_, called(context, "at")),
                   not_at_.empty() ? std::vector<Vec3d>() : points_of(not_at_, called(context, "not_at")), options_);
        Result result;
        result.input = {tree_};
        result.notes = fitted.notes;
        const bool found = fitted.primitive.fit.has_shape();
        if (!found && context.face == Face::dialog) refuse(fitted.primitive);
        fitted.primitive.name =
            name_.empty() && list_.empty() ? traits_of(fitted.primitive.fit.shape.kind).label : name_;
        if (context.window.keep_fit) {
            fitted.primitive.name = name_;
            context.window.keep_fit(fitted);
        }
        SetDone done;
        if (found) {
            // The list first: points that are deleted cannot be fitted again.
            if (!list_.empty()) run_last_step(result.outcome, [&] { add_to_list(list_, fitted.primitive); });
            write_drawing(*cloud, fitted.primitive, result);
            done = do_with_points(context, fitted);
        }
        result.outcome.points_in = result.outcome.points_out = fitted.points.size();
        result.accuracy = exact_answer();
        if (found) result.accuracy = accuracy_of_fit(fitted.primitive.fit);
        describe(result, fitted, done);
        result.good = found;
        return result;
    }

private:
    void declare_shape()
    {
        const char* const group = "Shape";
        arguments_.add("at", at_).required().count(1, 3000).script("Places").group(group).label("Places").help(
            "A place \"X Y Z\" on the surface, source coordinates; more of them refine the fit");
        arguments_.add("not_at", not_at_)
            .count(1, 3000)
            .script("NotPlaces")
            .group(group)
            .label("Other places")
            .help("A place \"X Y Z\" that is not part of it: points around it are ignored and not reached")
            .without("none");
        arguments_.add("shape", shape_)
            .as(ValueKind::choice)
            .one_of(shape_choices())
            .group(group)
            .label("Shape")
            .help(
                "What to fit. any: each kind is fitted, and the one that explains the points best, with the fewest "
                "parameters, is kept");
        arguments_.add("radius", options_.radius)
            .positive()
            .unit("source units")
            .group(group)
            .label("Radius of the neighbourhood")
            .help("Neighbourhood of a place: all points within this distance")
            .automatic("a number of points");
        arguments_.add("count", options_.count)
            .advanced()
            .group(group)
            .label("Points of the neighbourhood")
            .help("Neighbourhood of a place: its nearest points")
            .automatic("500, and more while the fit is not good");
        arguments_.add("least_radius", options_.fit.least_radius)
            .not_negative()
            .unit("source units")
            .group(group)
            .label("Radius from")
            .help("Smaller radii (of a torus: of its tube) are not considered")
            .automatic("any")
            .advanced();
        arguments_.add("largest_radius", largest_radius_)
            .positive()
            .unit("source units")
            .group(group)
            .label("Radius to")
            .help("Larger radii (of a torus: of its tube) are not considered")
            .without("any")
            .advanced();
    }

    void declare_estimator()
    {
        const char* const group = "Estimator";
        arguments_.choice("estimator", options_.fit.estimator, estimator_choices())
            .advanced()
            .group(group)
            .label("Estimator")
            .help(
                "How samples are drawn and scored, where some of the points belong to something else; msac suits "
                "nearly all scans");
        arguments_.add("threshold", options_.fit.threshold)
            .positive()
            .unit("source units")
            .group(group)
            .label("Threshold")
            .help("Largest distance of a point from the surface")
            .automatic("from the noise of the points around the place");
        arguments_.add("normal_angle", normal_angle_)
            .positive()
            .degrees()
            .group(group)
            .label("Normals within")
            .help(
                "Largest angle between the shape and the surface of the points around a point: growth does not pass "
                "where it is larger; 90: not compared. Where it is given and the cloud has normals, these are "
                "compared, too")
            .automatic("30, computed from the points, and with a threshold not compared")
            .advanced();
        arguments_.add("iterations", options_.fit.iterations)
            .between(1, 4294967295.0)
            .group(group)
            .label("Samples")
            .help("Maximum number of samples of points that the search tries")
            .advanced();
        arguments_.add("probability", options_.fit.probability)
            .between(1e-9, 1 - 1e-9)
            .group(group)
            .label("Probability")
            .help("Probability, below 1, that a sample without outliers was drawn, which ends the search")
            .advanced();
        arguments_.add("seed", options_.fit.seed)
            .group(group)
            .label("Seed")
            .help("Start of the random numbers that draw the samples: the same seed gives the same result")
            .advanced();
        arguments_.choice("backend", options_.fit.backend, {{"own", "Own"}, {"pcl", "PCL"}})
            .group(group)
            .label("Computed by")
            .help("own, or pcl: the Point Cloud Library, for comparison")
            .shown(has_pcl())
            .advanced();
    }

    void declare_limit()
    {
        arguments_.add("time_limit", options_.fit.seconds)
            .also("seconds")
            .script("Seconds")
            .positive()
            .unit("s")
            .group("Estimator")
            .label("Time limit")
            .help("Time limit: the search then keeps the best shape so far, which is not followed any farther")
            .automatic("no limit")
            .advanced();
    }

    void declare_registration()
    {
        const char* const group = "Estimator";
        arguments_.add("registration", options_.registration)
            .positive()
            .unit("mm")
            .group(group)
            .label("Registration within")
            .help(registration_help)
            .automatic("what the stations show; else the +- contains the noise of the points alone");
    }

    void declare_growth()
    {
        const char* const group = "Growth over the cloud";
        arguments_.add("grow", options_.grow)
            .group(group)
            .label("Follow through the cloud")
            .help(
                "All connected points of the cloud on the surface belong to the shape, which is fitted to them again; "
                "off: only points of the neighbourhood");
        arguments_.add("step", options_.step)
            .advanced()
            .positive()
            .unit("source units")
            .group(group)
            .label("Longest step")
            .help("Maximum distance from point to point, by which the surface is followed")
            .automatic("from the gaps");
        arguments_.add("rounds", options_.rounds)
            .between(0, 100)
            .group(group)
            .label("Rounds")
            .help(
                "Maximum number of rounds of growing and fitting to all points reached; 0: the shape of the first fit")
            .advanced();
        arguments_.add("outline", outline_)
            .advanced()
            .as(ValueKind::choice)
            .one_of({{"rectangle", "Rectangle"}, {"convex", "Convex"}, {"concave", "Concave"}, {"box", "Cloud's box"}})
            .group(group)
            .label("Outline")
            .help(
                "How a plane is bounded, and what its area is: concave follows the points' edge and gaps, convex is "
                "their hull, rectangle the smallest around the points, box where the cloud's box cuts it");
        arguments_.add("outline_edge", options_.outline.edge)
            .positive()
            .unit("source units")
            .group(group)
            .label("Edge of the outline")
            .help("Concave outlines: narrower gaps are closed")
            .automatic("from the spacing")
            .advanced();
    }

    void check(const Context& context) const
    {
        const bool is_command = context.face == Face::command;
        actions_.check(tree_, is_command && out_.empty());
        if (options_.radius > 0 && options_.count > 0)
            throw ArgumentError(called(context, "radius") + " and " + called(context, "count") +
                                ", of the neighbourhood, cannot be combined");
        if (!options_.grow && options_.step > 0)
            throw ArgumentError(called(context, "step") + " is for growth; " + called(context, "grow") +
                                (is_command ? " was given" : " is off"));
        if (options_.outline.edge > 0 && outline_ != "concave")
            throw ArgumentError(called(context, "outline_edge") + " is for " + called(context, "outline") + " concave");
        if (is_command && !name_.empty() && list_.empty()) throw ArgumentError("--name is for --add");
        if (!out_.empty()) check_primitive_file(out_, actions_.overwrite());
    }

    void set_options(const Context& context)
    {
        if (const auto kind = shape_kind(shape_))
            options_.fit.kind = *kind;
        else
            for (const ShapeTraits& row : shape_kinds()) options_.kinds.push_back(row.kind);
        if (largest_radius_) options_.fit.largest_radius = *largest_radius_;
        if (normal_angle_ > 0) options_.fit.normal_angle = options_.turned_angle = normal_angle_;
        options_.limit = region_.get();
        clip_.add_to(options_.limit, context);
        options_.outline.kind = *outline_kind(outline_);
        options_.threads = work_.threads;
        options_.memory_bytes = work_.memory;
        options_.progress = context.progress;
    }

    [[noreturn]] void refuse(const Primitive& primitive) const
    {
        throw Error(ErrorCode::invalid_argument, tree_,
                    std::string("no ") + traits_of(primitive.fit.shape.kind).name + " was fitted (" +
                        name_of(primitive.fit.issue) + ")",
                    primitive.fit.message);
    }

    void write_drawing(const PointCloud& cloud, const Primitive& primitive, Result& result) const
    {
        if (out_.empty()) return;
        CadOptions options = drawing_.options(length_unit_of(system_of(cloud)));
        options.overwrite = actions_.overwrite();
        const CadReport report = write_primitives(out_, {primitive}, options);
        result.notes.insert(result.notes.end(), report.notes.begin(), report.notes.end());
        result.output = out_;
        result.makes = Makes::file;
    }

    // When the primitive is in the list, a failure is not a reason to repeat the whole command: the primitive would be
    // in it twice.
    SetDone do_with_points(const Context& context, const FittedPrimitive& fitted) const
    {
        try {
            return actions_.run(fitted.points, context, work_.memory, work_.threads);
        } catch (const Error& error) {
            if (list_.empty()) throw;
            throw Error::after(list_, fitted.primitive.name + " was added", error);
        }
    }

    void describe(Result& result, const FittedPrimitive& fitted, const SetDone& done) const
    {
        Json& json = result.values;
        json["primitive"] = json_of(fitted.primitive);
        json["sigma_contains"] =
            fitted.primitive.fit.has_shape() ? Json(contained_in_errors(fitted.primitive)) : Json();
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
        json["departure"] = Json();
        if (fitted.departure) json["departure"] = {{"rms", fitted.departure->size}, {"noise", fitted.departure->rest}};
        json["list"] = list_.empty() ? Json() : Json(list_);
        put_lines(result, fitted.primitive);
        const bool found = fitted.primitive.fit.has_shape();
        if (found) put_points_lines(result, fitted);
        if (!list_.empty() && found)
            result.line(list_ + ": " + fitted.primitive.name + " added" +
                        (fitted.primitive.fit.verdict == FitVerdict::doubtful ? ", as doubtful" : ""));
        if (!out_.empty() && found) result.line(out_ + ": 1 primitive");
        put_done(result, done);
    }

    static std::vector<std::string> contained_in_errors(const Primitive& primitive)
    {
        std::vector<std::string> names{"noise"};
        if (!primitive.stations) return names;
        const StationFacts& facts = *primitive.stations;
        if (facts.contained() > 0) names.push_back(facts.registration > facts.spread ? "registration" : "stations");
        if (facts.ray_share > 0) names.push_back("rays");
        return names;
    }

    void put_points_lines(Result& result, const FittedPrimitive& fitted) const
    {
        const std::string growth = !fitted.left_surface.empty() ? ", and not followed: " + fitted.left_surface
                                   : fitted.rounds == 0         ? ""
                                                                : ", grown by steps of " + brief(fitted.step);
        result.line(tree_ + ": " + counted(fitted.points.size(), "point", "belongs", "belong") + " to it; fitted to " +
                    grouped(fitted.local.inliers) + " of " + points_text(fitted.near.ids.size()) + " around the place" +
                    growth);
        if (fitted.rounds > 0 && !fitted.converged && fitted.left_surface.empty())
            result.print("note: the shape still changed in the last of %u rounds of growth", fitted.rounds);
    }

    std::string tree_, list_, name_, out_;
    std::vector<double> at_, not_at_;
    std::string shape_ = "any", outline_ = "concave";
    std::optional<double> largest_radius_;
    double normal_angle_ = 0;
    FitAtOptions options_;
    RegionArguments region_;
    ClipArgument clip_;
    DrawingArguments drawing_;
    PointSetActions actions_;
    WorkArguments work_;
};

}  // namespace

Row fit_row()
{
    return {
        "fit",
        "Fit Primitive",
        "Fit a plane, cylinder, sphere, cone or torus at a place of a tree, follow it through the cloud; export, "
        "extract "
        "or delete it",
        "Fits a plane, cylinder, sphere, cone or torus to the points around given places of a <b>point cloud tree</b> "
        "and follows it through the whole cloud, with standard deviations, which contain how far the stations of a "
        "scanner are apart where the points show it or it is given. In a project the primitive is added to its "
        "list, which the tool <i>Fit Primitives</i> shows, and its points are selected; they are written as a tree or "
        "file on request. Fits that the points do not determine are refused or reported as doubtful.",
        menu::measure | menu::points,
        nullptr,
        with_done_keys(
            {{"primitive", "object", "",
              "as in a list of primitives, with sigma.position along the direction in which the position is "
              "least certain; or kind, verdict, issue and message"},
             {"sigma_contains", "list?", "",
              "errors that primitive.sigma contains: noise; stations (shifted and turned by their "
              "spread, found) or registration (given); rays (what may be left of errors along a scanner's rays)"},
             {"neighbourhood", "object", "", "points, found, radius, spacing and inliers of the first fit"},
             {"growth", "object?", "", "step, rounds, converged, left_surface"},
             {"departure", "object?", "source units",
              "for points that leave the shape together, as where it is out of round or bulged: rms, of the "
              "smooth surface that they keep to from the shape, and noise, of the points from that surface"},
             {"list", "text?", "", "list that it was added to"}}),
        make<Fit>,
        {},
        "An error target is not taken: the error follows from the noise and the number of the points, not from the "
        "search."};
}

}  // namespace pcm::ops
