#include "pcm/detect/detect.h"

#include "pcm/cad/dxf_file.h"
#include "pcm/cad/primitive_files.h"
#include "pcm/cli/attribute_options.h"
#include "pcm/cli/common.h"
#include "pcm/cli/primitive_output.h"
#include "pcm/cli/region_options.h"
#include "pcm/system/error.h"
#include "pcm/system/output_group.h"
#include "pcm/system/peak_memory.h"
#include "pcm/system/rounded_text.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

constexpr double degree = pi / 180;

struct Arguments {
    Common common;
    std::string tree;
    std::vector<std::string> shapes;
    RegionOptions region;
    std::optional<double> normal_angle;
    DetectOptions options;
    std::string out, label;
    TargetOptions target;
};

void check(const Arguments& arguments)
{
    const bool has_target = !arguments.target.output.empty() || arguments.target.in_place;
    if (!arguments.label.empty() && arguments.target.output.empty() == !arguments.target.in_place)
        throw UsageError("--label needs either -o COPY, a tree to write, or --in-place");
    if (arguments.label.empty() && has_target) throw UsageError("-o and --in-place are for --label");
    if (arguments.target.overwrite && arguments.out.empty() && arguments.label.empty())
        throw UsageError("--overwrite is for --out and --label");
    // Before the work, not after it.
    if (!arguments.out.empty()) check_primitive_file(arguments.out, arguments.target.overwrite);
    if (!arguments.label.empty()) check_target(arguments.tree, arguments.target.get());
}

std::string row_of(const Primitive& p)
{
    const ShapeFit& fit = p.fit;
    const ShapeTraits& traits = traits_of(fit.shape.kind);
    std::string text = std::string(traits.name) + " " + rounded_text(fit.shape.point, fit.errors.position) + " +- " +
                       brief(fit.errors.position);
    if (traits.axis)
        text += (fit.shape.kind == ShapeKind::plane ? ", normal " : ", axis ") +
                rounded_text(fit.shape.axis, fit.errors.angle) + " +- " + brief(fit.errors.angle / degree) + " degrees";
    if (traits.radius)
        text += ", radius " + rounded_text(fit.shape.radius, fit.errors.radius) + " +- " + brief(fit.errors.radius);
    if (fit.verdict != FitVerdict::good) text += "  (" + std::string(name_of(fit.verdict)) + ")";
    return text;
}

void print_text(const Arguments& arguments, const DetectReport& found, const LabelReport& labels,
                const std::vector<std::string>& notes)
{
    if (!found.primitives.empty()) std::printf("%5s  %12s  %9s  %s\n", "label", "points", "noise", "shape");
    for (const Primitive& p : found.primitives)
        std::printf("%5u  %12s  %9s  %s\n", p.label, grouped(p.points).c_str(), brief(p.fit.noise).c_str(),
                    row_of(p).c_str());
    for (const std::string& note : notes) std::printf("note: %s\n", note.c_str());
    if (!arguments.out.empty() && !found.primitives.empty()) std::printf("%s: written\n", arguments.out.c_str());
    if (!arguments.label.empty())
        std::printf("%s: attribute %s written, %s values changed\n", labels.tree.string().c_str(),
                    arguments.label.c_str(), grouped(labels.outcome.points_out).c_str());
    std::printf("%s: %zu primitives with %s of %s points; threshold %s, cloud's noise %s, spacing %s\n",
                arguments.tree.c_str(), found.primitives.size(), grouped(found.outcome.points_out).c_str(),
                grouped(found.outcome.points_in).c_str(), brief(found.threshold).c_str(), brief(found.noise).c_str(),
                brief(found.spacing).c_str());
    std::printf("%.1f s, peak memory %s\n", found.outcome.seconds, bytes_text(peak_memory_bytes()).c_str());
}

void report_json(const Arguments& arguments, const DetectReport& found, const LabelReport& labels,
                 const std::vector<std::string>& notes)
{
    Json json;
    json["tree"] = arguments.tree;
    put_outcome(json, found.outcome);
    json["points_in"] = found.outcome.points_in;
    json["threshold"] = found.threshold;
    json["step"] = found.step;
    json["noise"] = found.noise;
    json["spacing"] = found.spacing;
    json["sample_cell"] = found.sample;
    json["primitives"] = Json::array();
    for (const Primitive& p : found.primitives) json["primitives"].push_back(json_of(p));
    json["list"] = arguments.out.empty() ? Json() : Json(arguments.out);
    json["labelled_tree"] = arguments.label.empty() ? Json() : Json(labels.tree.string());
    json["points_changed"] = labels.outcome.points_out;
    json["notes"] = notes;
    print_json(json);
}

// The list of primitives, when the labels are written: then its failure is no reason to repeat the command.
void put_in_place(OutputGroup& list, const Arguments& arguments, const LabelReport& labels, Outcome& outcome)
{
    run_last_step(outcome, [&] {
        try {
            list.put_in_place();
        } catch (const Error& error) {
            if (arguments.label.empty() || error.is_done()) throw;
            throw Error::after(labels.tree, "the labels are written, and the list is not", error);
        }
    });
}

int run(Arguments& arguments)
{
    check(arguments);
    DetectOptions& options = arguments.options;
    options.limit = arguments.region.get();
    if (!arguments.shapes.empty()) options.kinds.clear();
    for (const std::string& name : arguments.shapes) options.kinds.push_back(*shape_kind(name));
    if (arguments.normal_angle) options.normal_angle = *arguments.normal_angle * degree;
    options.progress = console_progress(arguments.common);
    const auto tree = Tree::open(arguments.tree);
    LabelOptions label;
    if (!arguments.label.empty()) label.target = arguments.target.get();
    label.attribute = arguments.label;
    label.overwrite = arguments.target.overwrite;
    label.memory_bytes = options.memory_bytes;
    label.threads = options.threads;
    label.progress = console_progress(arguments.common);
    if (!arguments.label.empty()) check_label_attribute(*tree, label);
    DetectReport found = detect_primitives(tree, options);
    std::vector<std::string> notes = found.notes;
    // The list is complete before the labels are written, and gets its name after that: both or none.
    OutputGroup list;
    if (!arguments.out.empty()) {
        if (found.primitives.empty()) {
            notes.push_back("no primitive was found, so " + arguments.out + " was not written");
        } else {
            CadOptions cad;
            cad.overwrite = arguments.target.overwrite;
            const CadReport written = write_primitives(arguments.out, found.primitives, cad);
            notes.insert(notes.end(), written.notes.begin(), written.notes.end());
        }
    }
    LabelReport labels;
    if (!arguments.label.empty()) {
        labels = label_primitives(tree, found, label);
        found.outcome.warnings.insert(found.outcome.warnings.end(), labels.outcome.warnings.begin(),
                                      labels.outcome.warnings.end());
    }
    put_in_place(list, arguments, labels, found.outcome);
    end_progress(arguments.common);
    if (arguments.common.json)
        report_json(arguments, found, labels, notes);
    else
        print_text(arguments, found, labels, notes);
    return finished(found.outcome);
}

void add_search(Options& options, Arguments& arguments)
{
    DetectOptions& detect = arguments.options;
    const char* const group = "What to find";
    options.option("--shape", arguments.shapes, "A kind of shape (default: all three)")
        .one_of({"plane", "cylinder", "sphere"})
        .one_value_each()
        .group(group);
    options
        .option("--threshold", detect.threshold,
                "Largest distance of a point from its surface, source units (default: from the cloud's noise)")
        .positive()
        .group(group);
    options.option("--min-points", detect.least_points, "Least number of points of a primitive (default 500)")
        .group(group);
    options
        .option("--normal-angle", arguments.normal_angle,
                "Largest angle between the normals of a point and of its surface, degrees (default 20)")
        .between(0.1, 90.0)
        .group(group);
    options
        .option("--step", detect.step,
                "Points farther apart are not of one primitive, source units, up to some 60 spacings (default: as the "
                "spacing around each point allows)")
        .positive()
        .group(group);
    options
        .flag("--pieces", detect.pieces,
              "Keep pieces of surfaces that bend away from the shape, as doubtful ones: ground, uneven floors")
        .group(group);
    options.option("--seed", detect.seed, "Seed of the search (default 1)").group(group);
}

}  // namespace

Run add_detect(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    DetectOptions& detect = arguments->options;
    options.positional("tree", arguments->tree, "Tree folder, or any file of it").required();
    add_search(options, *arguments);
    arguments->region.add_to(options, "Points to look at");
    const char* const group = "What to write";
    options
        .option("--out", arguments->out,
                std::string("List of the primitives (.json), table (.csv) or drawing (") +
                    (writes_dxf() ? ".dxf, .scr" : ".scr") + "), by the extension")
        .group(group);
    options
        .flag(
            "--overwrite", arguments->target.overwrite,
            "Replace the file of --out and the tree of -o if they exist; write --label where the tree has an attribute "
            "of this name from elsewhere, whose values are lost")
        .group(group);
    options
        .option("--label", arguments->label,
                "Write this attribute (u32): the label of each point's primitive, or 0; --where NAME=3 selects them")
        .group(group);
    arguments->target.add_to(options);
    options.option("-m,--memory", detect.memory_bytes, "Memory, e.g. 512M (default 256M)").bytes();
    options.option("-t,--threads", detect.threads, "Threads (default: one per processor)");
    add_common(options, arguments->common);
    return [arguments] { return run(*arguments); };
}

}  // namespace pcm::cli
