// All planes, cylinders and spheres of a cloud.
#include "pcm/detect/detect.h"
#include "pcm/detect/add_elbows.h"

#include "pcm/cloud/numbers.h"
#include "pcm/ops/shared/drawing_arguments.h"
#include "pcm/ops/shared/measure_report.h"
#include "pcm/ops/shared/primitive_report.h"
#include "pcm/ops/shared/region_arguments.h"
#include "pcm/ops/shared/target_arguments.h"
#include "pcm/ops/shared/window_arguments.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/place/depth_levels.h"
#include "pcm/system/counted.h"
#include "pcm/system/error.h"
#include "pcm/system/output_group.h"
#include "pcm/system/rounded_text.h"
#include "pcm/system/text.h"

#include <cstdio>

namespace pcm::ops {
namespace {

std::string shape_text(const Primitive& p)
{
    const ShapeFit& fit = p.fit;
    const ShapeTraits& traits = traits_of(fit.shape.kind);
    std::string text = std::string(traits.name) + " " + rounded_text(fit.shape.point, fit.errors.position) + " +- " +
                       brief(fit.errors.position);
    if (traits.has_axis())
        text += std::string(", ") + traits.axis_name() + " " + rounded_text(fit.shape.axis, fit.errors.angle) + " +- " +
                brief(fit.errors.angle / degree) + " degrees";
    if (traits.has_radius())
        text += ", radius " + rounded_text(fit.shape.radius, fit.errors.radius) + " +- " + brief(fit.errors.radius);
    if (fit.verdict != FitVerdict::good) text += "  (" + std::string(name_of(fit.verdict)) + ")";
    return text;
}

std::string columns(const std::string& label, const std::string& points, const std::string& noise,
                    const std::string& shape)
{
    char text[64];
    std::snprintf(text, sizeof text, "%5s  %12s  %9s  ", label.c_str(), points.c_str(), noise.c_str());
    return text + shape;
}

class Detect : public Operation {
public:
    Detect()
    {
        target_.declare_tree(arguments_);
        declare_kinds();
        declare_search();
        declare_registration();
        region_.declare(arguments_, "Points to look at");
        clip_.declare(arguments_);
        declare_outputs();
        work_.declare(arguments_, options_.memory_bytes, "the search");
    }

    Result answer(const Context& context) override
    {
        const bool has_target = !target_.output.empty() || target_.in_place;
        if (context.face == Face::dialog) label_ = labelled_ ? attribute_ : "";
        // A tree to write is one with labels.
        if (context.face == Face::command && label_.empty() && has_target) label_ = attribute_;
        check(context);
        choose_kinds(context);
        options_.limit = region_.get();
        clip_.add_to(options_.limit, context);
        options_.memory_bytes = work_.memory;
        options_.threads = work_.threads;
        options_.progress = context.progress;
        const auto cloud = context.open(target_.tree);
        const LabelOptions label = label_options(context);
        if (!label_.empty()) check_label_attribute(*cloud->tree(), label);
        DetectReport found = detect_primitives(cloud->tree(), options_);
        for (Primitive& one : found.primitives) doubt_level(*cloud, options_.limit, one);
        add_elbows(*cloud, found);
        Result result;
        result.notes = found.notes;
        if (context.window.keep_primitives && !found.primitives.empty())
            context.window.keep_primitives(found.primitives);
        // The list is complete before the labels are written, and gets its name after that: both or none.
        OutputGroup list;
        write_list(found, length_unit_of(system_of(*cloud)), result);
        LabelReport labels;
        if (!label_.empty()) {
            labels = label_primitives(cloud->tree(), found, label);
            found.outcome.warnings.insert(found.outcome.warnings.end(), labels.outcome.warnings.begin(),
                                          labels.outcome.warnings.end());
        }
        put_in_place(list, labels, found.outcome);
        describe(result, found, labels);
        return result;
    }

private:
    void declare_kinds()
    {
        const char* const group = "What to find";
        arguments_.add("shape", shapes_)
            .only(Face::command)  // dialogs have a switch for each kind
            .one_of({{"plane", "Plane"}, {"cylinder", "Cylinder"}, {"sphere", "Sphere"}})
            .group(group)
            .help("A kind of shape")
            .without("all three");
        for (const ShapeKind kind : options_.kinds) {
            bool& wanted = wanted_[static_cast<std::size_t>(kind)];
            const std::string name = traits_of(kind).name;
            arguments_.add("find_" + name + "s", wanted)
                .only(Face::dialog)
                .script(std::string(traits_of(kind).label) + "s")
                .label(std::string(traits_of(kind).label) + "s")
                .help("Detect " + name + "s");
        }
    }

    void declare_search()
    {
        const char* const group = "What to find";
        arguments_.add("min_points", options_.least_points)
            .script("LeastPoints")
            .group(group)
            .label("Minimum points")
            .help("Minimum number of points of a primitive");
        arguments_.add("threshold", options_.threshold)
            .positive()
            .unit("source units")
            .group(group)
            .label("Threshold")
            .help("Largest distance of a point from its surface")
            .automatic("from the cloud's noise");
        arguments_.add("normal_angle", options_.normal_angle)
            .degrees()
            .between(0.1, 90)
            .group(group)
            .label("Normals within")
            .help("Largest angle between the normals of a point and of its surface");
        arguments_.add("step", options_.step)
            .positive()
            .unit("source units")
            .group(group)
            .label("Longest step")
            .help("Points farther apart are not of one primitive; up to some 60 spacings")
            .automatic("as the spacing around each point allows");
        arguments_.add("pieces", options_.pieces)
            .group(group)
            .label("Cut-outs of curved surfaces")
            .help("Keep pieces of surfaces that bend away from the shape, as doubtful ones: ground, uneven floors");
        arguments_.add("seed", options_.seed)
            .group(group)
            .label("Seed")
            .help("Start of the random numbers of the search: the same seed gives the same result")
            .advanced();
    }

    void declare_registration()
    {
        arguments_.add("registration", options_.registration)
            .positive()
            .unit("mm")
            .group("What to find")
            .label("Registration within")
            .help(registration_help)
            .automatic("what the stations show; else the +- contains the noise of the points alone");
    }

    void declare_outputs()
    {
        const char* const group = "What to write";
        arguments_.add("out", out_)
            .as(ValueKind::output)
            .script("OutputFile")
            .group(group)
            .label("Output file")
            .help("File to write the primitives to, in source coordinates: " + drawing_formats() + ", as its name ends")
            .without("no file");
        drawing_.declare(arguments_);
        arguments_.add("label", label_)
            .only(Face::command)  // dialogs have a switch, and a name of their own
            .group(group)
            .help("Write this attribute (u32): the label of each point's primitive, or 0; --where NAME=3 selects them")
            .without("none; with -o or --in-place " + attribute_);
        arguments_.add("labels", labelled_)
            .only(Face::dialog)
            .label("Label the points")
            .help(
                "Write which primitive each point belongs to as an attribute: its number in the list, or 0. Into a "
                "copy of the tree, or in place");
        arguments_.add("attribute", attribute_)
            .only(Face::dialog)
            .label("Attribute")
            .help("Name of the attribute that gets the labels");
        target_.declare_target(arguments_, "the labels");
        arguments_.find("overwrite")
            ->help(
                "Replace the output file and the output tree if they exist; write the labels where the tree has an "
                "attribute of this name from elsewhere, whose values are lost");
    }

    void check(const Context& context)
    {
        if (target_.overwrite && out_.empty() && label_.empty() && context.face == Face::command)
            throw ArgumentError("--overwrite is for --out, -o and --label");
        // Before the work, not after it.
        drawing_.overwrite = target_.overwrite;
        if (!out_.empty()) check_primitive_file(out_, target_.overwrite);
        if (label_.empty()) return;
        check_target(target_.tree, target_.choice(context.face, arguments_));
        if (target_.in_place && context.window.refuse_change) context.window.refuse_change(target_.tree);
    }

    void choose_kinds(const Context& context)
    {
        std::vector<ShapeKind> kinds;
        if (context.face == Face::dialog) {
            for (const ShapeKind kind : options_.kinds)
                if (wanted_[static_cast<std::size_t>(kind)]) kinds.push_back(kind);
            if (kinds.empty()) throw ArgumentError("no kind of primitive is chosen: switch one on");
        }
        for (const std::string& name : shapes_) kinds.push_back(*shape_kind(name));
        if (!kinds.empty()) options_.kinds = std::move(kinds);
    }

    LabelOptions label_options(const Context& context) const
    {
        LabelOptions label;
        if (!label_.empty()) label.target = target_.choice(context.face, arguments_);
        label.attribute = label_;
        label.overwrite = target_.overwrite;
        label.memory_bytes = options_.memory_bytes;
        label.threads = options_.threads;
        label.progress = context.progress;
        return label;
    }

    void add_elbows(const PointCloud& cloud, DetectReport& found) const
    {
        ElbowOptions elbows;
        elbows.limit = options_.limit;
        elbows.registration = options_.registration;
        elbows.memory_bytes = options_.memory_bytes;
        elbows.threads = options_.threads;
        elbows.progress = options_.progress;
        const std::size_t before = found.primitives.size();
        const std::size_t count = pcm::add_elbows(cloud, elbows, found);
        if (count == 0) return;
        std::string note = counted(count, "elbow") + " between pipes: fitted to the points there";
        if (const std::size_t pieces = before + count - found.primitives.size(); pieces > 0)
            note += ", in place of " + counted(pieces, "cylinder") + " along them";
        found.notes.push_back(note);
    }

    void write_list(const DetectReport& found, const std::string& unit, Result& result) const
    {
        if (out_.empty()) return;
        if (found.primitives.empty()) {
            result.notes.push_back("no primitive was found, so " + out_ + " was not written");
            return;
        }
        const CadReport written = write_primitives(out_, found.primitives, drawing_.options(unit));
        result.notes.insert(result.notes.end(), written.notes.begin(), written.notes.end());
        result.output = out_;
        result.makes = Makes::file;
    }

    // The list of primitives, when the labels are written: a failure is then not a reason to repeat the operation.
    void put_in_place(OutputGroup& list, const LabelReport& labels, Outcome& outcome) const
    {
        run_last_step(outcome, [&] {
            try {
                list.put_in_place();
            } catch (const Error& error) {
                if (label_.empty() || error.is_done()) throw;
                throw Error::after(labels.tree, "the labels are written, and the list is not", error);
            }
        });
    }

    void describe(Result& result, const DetectReport& found, const LabelReport& labels) const
    {
        if (!label_.empty()) {
            target_.describe(result, labels.tree.string());
            result.lines.clear();
        }
        result.input = {target_.tree};
        result.outcome = found.outcome;
        result.accuracy = bounded(found.outcome.error, "distances of points from their primitives");
        Json& json = result.values;
        json["threshold"] = found.threshold;
        json["step"] = found.step;
        json["noise"] = found.noise;
        json["spacing"] = found.spacing;
        json["sample_cell"] = found.sample;
        json["primitives"] = Json::array();
        for (const Primitive& p : found.primitives) json["primitives"].push_back(json_of(p));
        const std::vector<PipeRun> runs = pipe_runs(found.primitives);
        json["runs"] = json_of(runs);
        json["list"] = out_.empty() ? Json() : Json(out_);
        json["labelled_tree"] = label_.empty() ? Json() : Json(labels.tree.string());
        json["points_changed"] = labels.outcome.points_out;
        if (!found.primitives.empty()) result.line(columns("label", "points", "noise", "shape"));
        for (const Primitive& p : found.primitives)
            result.line(columns(std::to_string(p.label), grouped(p.points), brief(p.fit.noise), shape_text(p)));
        for (const PipeRun& run : runs) put_lines(result, run, "");
        if (!found.primitives.empty() && found.primitives.front().stations)
            result.line(spread_text(*found.primitives.front().stations));
        if (!out_.empty() && !found.primitives.empty()) result.line(out_ + ": written");
        if (!label_.empty())
            result.line(labels.tree.string() + ": attribute " + label_ + " written, " +
                        grouped(labels.outcome.points_out) + " values changed");
        result.line(target_.tree + ": " + std::to_string(found.primitives.size()) + " primitives with " +
                    grouped(found.outcome.points_out) + " of " + points_text(found.outcome.points_in) + "; threshold " +
                    brief(found.threshold) + ", cloud's noise " + brief(found.noise) + ", spacing " +
                    brief(found.spacing));
    }

    TargetArguments target_;
    DrawingArguments drawing_;
    RegionArguments region_;
    ClipArgument clip_;
    WorkArguments work_;
    DetectOptions options_;
    std::vector<std::string> shapes_;
    bool wanted_[5] = {true, true, true, true, true};  // indexed by ShapeKind
    bool labelled_ = false;
    std::string out_, label_, attribute_ = LabelOptions().attribute;
};

}  // namespace

Row detect_row()
{
    return {"detect",
            "Detect Primitives",
            "Detect the planes, cylinders and spheres of a tree, and label their points",
            "Finds all planes, cylinders and spheres of a <b>point cloud tree</b> that have at least a minimum number "
            "of points, in bounded memory, and fits them with standard deviations. In a project they are added to its "
            "list, which the tool <i>Fit Primitives</i> shows; they are written as a drawing or list on request; "
            "labels state which points belong to them.",
            menu::measure | menu::points,
            "-labelled.pct",
            {{"threshold", "number", "source units", "largest distance of a point from its surface"},
             {"step", "number", "source units", "longest step; 0: as the spacing allows"},
             {"noise", "number", "source units", "noise of the cloud"},
             {"spacing", "number", "source units", "spacing of the cloud"},
             {"sample_cell", "number", "source units", "shapes are searched in one point for each cell of this size"},
             {"primitives", "list", "", "as in a list of primitives, sorted by their number of points, descending"},
             {"runs", "list", "", pipe_runs_help},
             {"list", "text?", "", "file of the primitives"},
             {"labelled_tree", "text?", "", "tree that has the labels"},
             {"points_changed", "count", "points", "points whose label was changed"}},
            make<Detect>,
            {},
            "It takes neither a time limit nor an error target: a part of the shapes is no answer. --min-points and "
            "--threshold decide how long it takes."};
}

}  // namespace pcm::ops
