// A scan-like scene with exact ground truth.
#include "pcm/generate/scene.h"

#include "pcm/ops/shared/reading_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/text.h"

namespace pcm::ops {
namespace {

class Generate : public Operation {
public:
    Generate()
    {
        arguments_.add("output", output_)
            .as(ValueKind::output)
            .positional()
            .required()
            .label("Output file")
            .help("File to write; its extension sets the format: " + writable_text());
        arguments_.add("points", options_.points).letter('n').label("Points").help("Number of points");
        arguments_.add("origin", origin_)
            .count(3)
            .unit("metres")
            .label("Origin")
            .help("Map coordinates X,Y,Z of the scene's corner");
        arguments_.add("extent", options_.extent)
            .unit("metres")
            .label("Extent")
            .help("Side length of the scene")
            .without("grows with the number of points");
        arguments_.add("noise", options_.noise).unit("metres").label("Noise").help("Standard deviation of the range");
        arguments_.add("scale", options_.scale).unit("metres").label("Scale").help("Step of the coordinates");
        arguments_.add("seed", options_.seed).label("Seed").help("Seed of the random numbers");
        arguments_.add("truth", truth_).label("Ground truth").help("The ground truth next to the file");
        arguments_.add("overwrite", options_.overwrite).label("Overwrite").help("Replace existing files");
    }

    Result answer(const Context& context) override
    {
        options_.origin = {origin_[0], origin_[1], origin_[2]};
        options_.progress = context.progress;
        const SceneReport report = generate_scene(output_, options_, truth_);
        std::size_t planes = 0, cylinders = 0, spheres = 0;
        for (const ScenePrimitive& primitive : report.primitives)
            ++(primitive.kind == ScenePrimitive::Kind::plane      ? planes
               : primitive.kind == ScenePrimitive::Kind::cylinder ? cylinders
                                                                  : spheres);
        Result result;
        result.output = output_;
        result.makes = Makes::file;
        result.outcome = report.outcome;
        result.accuracy = rounded_positions(options_.scale / 2);
        result.notes = report.notes;
        result.values["planes"] = planes;
        result.values["cylinders"] = cylinders;
        result.values["spheres"] = spheres;
        result.print("%s: %s points in %.1f s (%.2f M points/s); %zu planes, %zu cylinders, %zu spheres",
                     output_.c_str(), grouped(report.outcome.points_out).c_str(), report.outcome.seconds,
                     points_per_second(report.outcome) / 1e6, planes, cylinders, spheres);
        return result;
    }

private:
    std::string output_;
    SceneOptions options_;
    std::vector<double> origin_{options_.origin.begin(), options_.origin.end()};
    bool truth_ = true;
};

}  // namespace

Row generate_row()
{
    return {"generate",
            nullptr,
            "Generate a scan-like scene with exact ground truth, as LAS or LAZ",
            "Writes a scene as a scanner would see it: ground, vegetation, and planes, cylinders and spheres whose "
            "exact places are written next to it.",
            0,
            nullptr,
            {{"planes", "count", "", "planes of the scene"},
             {"cylinders", "count", "", "cylinders of the scene"},
             {"spheres", "count", "", "spheres of the scene"}},
            make<Generate>,
            {},
            only_rounds};
}

}  // namespace pcm::ops
