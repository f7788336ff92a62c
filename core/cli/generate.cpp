#include "pcm/generate/scene.h"

#include "pcm/cli/common.h"
#include "pcm/io/writer.h"
#include "pcm/system/error.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string output;
    SceneOptions options;
    std::vector<double> origin;
    bool no_truth = false;
};

int generate(Arguments& arguments)
{
    if (!arguments.origin.empty())
        arguments.options.origin = {arguments.origin[0], arguments.origin[1], arguments.origin[2]};
    arguments.options.progress = console_progress(arguments.common);
    const SceneReport report = generate_scene(arguments.output, arguments.options, !arguments.no_truth);
    end_progress(arguments.common);
    std::size_t planes = 0, cylinders = 0, spheres = 0;
    for (const ScenePrimitive& primitive : report.primitives)
        ++(primitive.kind == ScenePrimitive::Kind::plane      ? planes
           : primitive.kind == ScenePrimitive::Kind::cylinder ? cylinders
                                                              : spheres);
    if (arguments.common.json) {
        Json json;
        json["file"] = arguments.output;
        put_outcome(json, report.outcome);
        json["planes"] = planes;
        json["cylinders"] = cylinders;
        json["spheres"] = spheres;
        json["notes"] = report.notes;
        print_json(json);
    } else {
        for (const std::string& note : report.notes) std::printf("note: %s\n", note.c_str());
        std::printf("%s: %s points in %.1f s (%.2f M points/s); %zu planes, %zu cylinders, %zu spheres\n",
                    arguments.output.c_str(), grouped(report.outcome.points_out).c_str(), report.outcome.seconds,
                    points_per_second(report.outcome) / 1e6, planes, cylinders, spheres);
    }
    return finished(report.outcome);
}

}  // namespace

Run add_generate(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    SceneOptions& scene = arguments->options;
    std::string writable;
    for (const std::string& extension : writable_extensions()) writable += (writable.empty() ? "" : ", ") + extension;
    options.positional("output", arguments->output, "File to write; its extension sets the format: " + writable)
        .required();
    options.option("-n,--points", scene.points, "Number of points (default 1000000)");
    options
        .option("--origin", arguments->origin,
                "Map coordinates X,Y,Z of the scene's corner, metres (default 500000,4800000,100)")
        .separated_by(',')
        .values(3);
    options.option("--extent", scene.extent,
                   "Side length of the scene, metres (default: grows with the number of points)");
    options.option("--noise", scene.noise, "Standard deviation of the range, metres (default 0.003)");
    options.option("--scale", scene.scale, "Step of the coordinates, metres (default 0.001)");
    options.option("--seed", scene.seed, "Seed of the random numbers (default 1)");
    options.flag("--no-truth", arguments->no_truth, "Do not write the ground truth next to the file");
    options.flag("--overwrite", scene.overwrite, "Replace existing files");
    add_common(options, arguments->common);
    return [arguments] { return generate(*arguments); };
}

}  // namespace pcm::cli
