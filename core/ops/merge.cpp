// Several trees become one.
#include "pcm/filter/merge.h"

#include "pcm/ops/shared/result_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

namespace pcm::ops {
namespace {

class Merge : public Operation {
public:
    Merge()
    {
        arguments_.add("visible_layers", visible_layers_)
            .only(Face::dialog)  // the command has no layers
            .label("Visible layers")
            .help("Merge the trees that the visible layers show");
        arguments_.add("apply_matrices", apply_matrices_)
            .only(Face::dialog)
            .label("Apply matrices")
            .help(
                "Each layer's tree is moved by the layer's matrix, as the view shows it. Off: all trees stay where "
                "their files say");
        arguments_.add("output", output_)
            .as(ValueKind::output_tree)
            .positional()
            .letter('o')
            .required()
            .label("Output folder")
            .help("The new tree's folder, by convention NAME.pct");
        arguments_.add("trees", trees_)
            .as(ValueKind::trees)
            .positional()
            .label("Other trees")
            .help("Tree folders, or any file of each")
            .without("none");
        arguments_.add("source_id", options_.source_id)
            .label("Add source_id")
            .help("Add an attribute source_id: the number of the tree that a point is from, from 1; notes have them");
        arguments_.add("ignore_crs", options_.ignore_crs)
            .label("Ignore coordinate systems")
            .help("Merge trees of different coordinate systems or GPS times, which is an error otherwise");
        arguments_.add("overwrite", to_.target.overwrite)
            .label("Overwrite")
            .help("Replace an existing tree of the output's name");
        work_.memory = to_.memory_bytes;
        work_.declare(arguments_, least_build_memory);
        chunk_points_argument(arguments_, to_.chunk_points);
    }

    Result answer(const Context& context) override
    {
        Result result;
        const std::vector<MergeInput> inputs = inputs_of(context, result);
        to_.target.copy = output_;
        to_.memory_bytes = work_.memory;
        to_.threads = work_.threads;
        to_.progress = context.progress;
        const MergeReport report = merge_trees(inputs, options_, to_);
        for (const MergeInput& input : inputs) result.input.push_back(input.tree.string());
        result.output = output_;
        result.makes = Makes::cloud;
        result.outcome = report.build.outcome;
        result.accuracy = rounded_positions(report.rounding);
        result.notes.insert(result.notes.end(), report.build.notes.begin(), report.build.notes.end());
        result.values["trees"] = report.trees;
        result.values["grid"] =
            report.grid ? Json({{"scale", report.grid->scale}, {"offset", report.grid->offset}}) : Json();
        result.values["largest_rounding"] = report.rounding;
        result.values["crs"] = report.system.empty() ? Json() : Json(report.system);
        result.values["bytes"] = report.build.bytes;
        write_lines(result, report);
        return result;
    }

private:
    // Those of visible layers, and those that are named.
    std::vector<MergeInput> inputs_of(const Context& context, Result& result) const
    {
        std::vector<MergeInput> inputs;
        if (context.layers && visible_layers_)
            for (const Layer& layer : context.layers()) {
                if (!layer.visible) continue;
                inputs.push_back({layer.tree, apply_matrices_ ? layer.map : std::nullopt});
                if (layer.map)
                    result.notes.push_back("the layer '" + layer.label + "' has a matrix: it is " +
                                           (apply_matrices_ ? "applied" : "not applied"));
            }
        for (const std::string& tree : trees_) inputs.push_back({tree, {}});
        if (inputs.empty() && context.face == Face::dialog)
            throw Error(ErrorCode::invalid_argument, {}, "there are no trees to merge",
                        "show layers of trees, or name tree folders");
        if (inputs.empty()) throw ArgumentError("trees is required");
        return inputs;
    }

    static void write_lines(Result& result, const MergeReport& report)
    {
        const Outcome& outcome = result.outcome;
        result.print("%s: %s points of %zu trees in %.1f s (%.2f M points/s), %s", result.output.c_str(),
                     grouped(outcome.points_out).c_str(), report.trees.size(), outcome.seconds,
                     points_per_second(outcome) / 1e6, bytes_text(report.build.bytes).c_str());
        if (report.grid)
            result.print("grid: steps %s, offset %s; coordinates changed by at most %s source units",
                         exact(report.grid->scale).c_str(), exact(report.grid->offset).c_str(),
                         exact(report.rounding).c_str());
        else
            result.print("positions are doubles, changed by at most %s source units", exact(report.rounding).c_str());
        result.print("coordinate system: %s", report.system.empty() ? "none stated" : report.system.c_str());
    }

    bool visible_layers_ = true, apply_matrices_ = true;
    std::string output_;
    std::vector<std::string> trees_;
    MergeOptions options_;
    ResultOptions to_;
    WorkArguments work_;
};

}  // namespace

Row merge_row()
{
    return {"merge",
            "Merge Point Cloud Trees",
            "Merge trees into a new tree",
            "Makes one <b>point cloud tree</b> of several: of the trees that visible layers show, where the layers' "
            "matrices put them, and of others on disk. Grids, attributes and coordinate systems are brought together; "
            "the notes say how. The trees are not changed.",
            menu::points | menu::layers,
            "-merged.pct",
            {{"trees", "list", "", "the trees, of source_id 1, 2, ..."},
             {"grid", "object?", "source units", "scale and offset of the result; null: positions are doubles"},
             {"largest_rounding", "number", "source units", "largest change of a coordinate"},
             {"crs", "text?", "", "coordinate system of the result; null: none is stated"},
             {"bytes", "count", "bytes", "size of the result"}},
            make<Merge>,
            {},
            only_rounds};
}

}  // namespace pcm::ops
