#include "pcm/ops/shared/target_arguments.h"

namespace pcm::ops {

void TargetArguments::declare_tree(Arguments& arguments)
{
    arguments.add("tree", tree)
        .as(ValueKind::tree)
        .positional()
        .required()
        .label("Tree folder")
        .help("Tree folder, or any file of it");
}

void TargetArguments::declare_cloud(Arguments& arguments)
{
    declare_tree(arguments);
    arguments.find("tree")->help(
        "Tree folder, or any file of it; on the command line also a file or a folder of files, with an output");
}

void TargetArguments::declare_target(Arguments& arguments, const std::string& lost)
{
    arguments.add("output", output)
        .letter('o')
        .as(ValueKind::output_tree)
        .label("Output folder")
        .help(
            "Tree folder to write, by convention NAME.pct: a copy that shares unchanged data with the original where "
            "the file system allows; on the command line of many operations also a file, NAME.laz or NAME.ply");
    arguments.add("in_place", in_place).label("In place").help("Change the tree itself, atomically");
    arguments.add("overwrite", overwrite)
        .label("Overwrite")
        .help("Replace an existing tree of the output's name" +
              (lost.empty() ? ""
                            : "; also write " + lost +
                                  " where the tree has an attribute of this name from elsewhere, whose values are "
                                  "lost"));
}

void TargetArguments::declare_copy(Arguments& arguments)
{
    changes_itself_ = true;
    declare_target(arguments, "");
    arguments.find("output")->without("the tree itself is changed");
    arguments.find("in_place")->only(Face::dialog);
}

TargetChoice TargetArguments::choice(Face face, const Arguments& arguments) const
{
    if (changes_itself_ && face == Face::command) return {output, output.empty(), overwrite};
    const std::string output_name = called(face, *arguments.find("output")),
                      in_place_name = called(face, *arguments.find("in_place"));
    if (output.empty() && !in_place)
        throw ArgumentError(face == Face::command
                                ? "no output is given: give " + output_name + " COPY, a tree to write, or " +
                                      in_place_name + " to change this one"
                                : "no output is given: name the tree to write as " + output_name + ", or switch on " +
                                      in_place_name);
    if (!output.empty() && in_place && face == Face::command)
        throw ArgumentError("give either " + output_name + ", a tree to write, or " + in_place_name + ", not both");
    if (in_place) return {{}, true, overwrite};
    return {output, false, overwrite};
}

void TargetArguments::describe(Result& result, const std::string& changed) const
{
    result.input = {tree};
    result.output = changed;
    result.makes = in_place || output.empty() ? Makes::changed : Makes::cloud;
}

}  // namespace pcm::ops
