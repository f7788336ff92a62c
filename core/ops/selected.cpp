// What is done with the points that a window has selected. On a command line `select` does the same with the points
// that it finds.
#include "pcm/cloud/las_class.h"
#include "pcm/ops/shared/point_set_actions.h"
#include "pcm/ops/shared/work_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/point_cloud.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

namespace pcm::ops {
namespace {

constexpr std::uint64_t usual_memory = std::uint64_t(256) << 20;
constexpr const char* about_selections =
    " Works on the current layer's selected points, made by the tool <i>Select Points</i> or the filter <i>Select "
    "Points of Point Cloud Tree</i>. A selection lasts until the tree changes or the project is closed; in a script of "
    "meshlabserver, for the one run.";

const PointSet& selected_points(const Context& context)
{
    if (!context.window.selected || context.window.selected->empty())
        throw Error(ErrorCode::invalid_argument,
                    context.window.cloud ? context.window.cloud->tree()->folder() : std::filesystem::path(),
                    "no point of the current layer is selected",
                    "select points with the tool Select Points or the filter Select Points of Point Cloud Tree");
    return *context.window.selected;
}

// A change of the selected points' tree.
class SelectedChange : public Operation {
public:
    Result answer(const Context& context) override
    {
        const PointSet& set = selected_points(context);
        target_.tree = set.tree().folder().string();
        SetChangeOptions options;
        options.target = target_.choice(context.face, arguments_);
        options.overwrite = target_.overwrite;
        options.memory_bytes = work_.memory;
        options.threads = work_.threads;
        options.progress = context.progress;
        const SetDone done = change(set, options);
        Result result;
        result.input = {target_.tree};
        result.outcome = done.outcome;
        result.accuracy = exact_answer();
        result.outcome.warnings.clear();  // put_done() has them
        put_done(result, done);
        return result;
    }

protected:
    // `attribute`: its values are lost with 'Overwrite' alone.
    void declare_target(const std::string& attribute)
    {
        target_.declare_target(arguments_, attribute);
        work_.declare(arguments_, usual_memory, "writing");
    }
    virtual SetDone change(const PointSet& set, const SetChangeOptions& options) const = 0;

private:
    TargetArguments target_;
    WorkArguments work_;
};

class SaveSelected : public SelectedChange {
public:
    SaveSelected()
    {
        arguments_.add("attribute", attribute_)
            .label("Attribute")
            .help(
                "Name of the attribute (u8) that becomes 1 for the selected points and 0 for all others; made when "
                "absent. The condition NAME=1 selects them again");
        declare_target("the attribute");
    }

private:
    SetDone change(const PointSet& set, const SetChangeOptions& options) const override
    {
        SetDone done = save_set(set, attribute_, options);
        done.subject = "attribute " + attribute_ + " is 1 for " + grouped(set.size()) + " of " +
                       points_text(done.outcome.points_in);
        return done;
    }
    std::string attribute_ = "selected";
};

class ClassifySelected : public SelectedChange {
public:
    ClassifySelected()
    {
        arguments_.add("value", value_)
            .as(ValueKind::whole)
            .between(-2147483648.0, 2147483647.0)
            .label("Class")
            .help(
                "Number that the selected points get; of LAS classes 2 is ground, 5 high vegetation, 6 building, 7 "
                "noise");
        arguments_.add("attribute", attribute_)
            .label("Attribute")
            .help("The integer attribute that is set; made (u8) when absent");
        declare_target("");
    }

private:
    SetDone change(const PointSet& set, const SetChangeOptions& options) const override
    {
        return classify_set(set, static_cast<std::int64_t>(value_), attribute_, options);
    }
    double value_ = 2;  // may be negative
    std::string attribute_ = "classification";
};

class DeleteSelected : public SelectedChange {
public:
    DeleteSelected() { declare_target(""); }

private:
    SetDone change(const PointSet& set, const SetChangeOptions& options) const override
    {
        return delete_set(set, options);
    }
};

class ExtractSelected : public Operation {
public:
    ExtractSelected()
    {
        arguments_.add("output", output_)
            .as(ValueKind::output)
            .label("Output")
            .help(
                "The tree folder (NAME.pct) or file to write; the extension chooses the format: las, laz, ply, e57, "
                "pcd, xyz, ... A name without extension is a tree");
        arguments_.add("overwrite", overwrite_).label("Overwrite").help("Replace the output if it exists");
        arguments_.add("add_layer", add_layer_)
            .label("Add a layer")
            .help("Show the result in a new layer, where it is a tree");
        work_.declare(arguments_, usual_memory, "writing");
    }

    Result answer(const Context& context) override
    {
        if (output_.empty()) throw ArgumentError("no output is given: name the tree or file to write");
        const PointSet& set = selected_points(context);
        ExtractOptions options;
        options.overwrite = overwrite_;
        options.memory_bytes = work_.memory;
        options.threads = work_.threads;
        options.progress = context.progress;
        std::filesystem::path output = output_;
        if (output.extension().empty()) output += ".pct";
        const SetDone done = extract_set(set, output.string(), options);
        Result result;
        result.input = {set.tree().folder().string()};
        result.outcome = done.outcome;
        result.accuracy = exact_answer();
        result.outcome.warnings.clear();  // put_done() has them
        put_done(result, done);
        if (!add_layer_ && result.makes == Makes::cloud) result.makes = Makes::file;
        return result;
    }

private:
    std::string output_;
    bool overwrite_ = false, add_layer_ = true;
    WorkArguments work_;
};

}  // namespace

Row save_selected_row()
{
    static const std::string details =
        std::string(
            "Writes which points are selected into an attribute of the <b>point cloud tree</b>, in a copy of it or in "
            "place.") +
        about_selections;
    return {"save_selected",
            "Selected Points: Save as Attribute",
            "Save which points are selected as an attribute",
            details.c_str(),
            menu::select | menu::points,
            "-selected.pct",
            with_done_keys({}),
            make<SaveSelected>,
            {},
            always_exact,
            true};
}

Row extract_selected_row()
{
    static const std::string details = std::string(
                                           "Writes the selected points of a <b>point cloud tree</b>, with all "
                                           "attributes and bit for bit, as a tree of "
                                           "their own or as a file. The tree is not changed.") +
                                       about_selections;
    return {"extract_selected",
            "Selected Points: Extract",
            "Write the selected points as a tree or a file",
            details.c_str(),
            menu::select | menu::layers | menu::points,
            "-part.pct",
            with_done_keys({}),
            make<ExtractSelected>,
            {},
            always_exact,
            true};
}

Row classify_selected_row()
{
    static const std::string details =
        std::string(
            "Sets the class, or another integer attribute, of the selected points of a <b>point cloud tree</b>, in a "
            "copy of it or in place.") +
        about_selections;
    return {"classify_selected",
            "Selected Points: Classify",
            "Set the class of the selected points",
            details.c_str(),
            menu::select | menu::points,
            "-classified.pct",
            with_done_keys({}),
            make<ClassifySelected>,
            {},
            always_exact,
            true};
}

Row delete_selected_row()
{
    static const std::string details =
        std::string(
            "Deletes the selected points of a <b>point cloud tree</b>, from a copy of it or in place. Only chunks that "
            "lose points are rewritten.") +
        about_selections;
    return {"delete_selected",
            "Selected Points: Delete",
            "Delete the selected points",
            details.c_str(),
            menu::select | menu::points,
            "-without.pct",
            with_done_keys({}),
            make<DeleteSelected>,
            {},
            always_exact,
            true};
}

}  // namespace pcm::ops
