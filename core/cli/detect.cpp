#include "pcm/primitives/detect.h"

#include "pcm/cli/attribute_options.h"
#include "pcm/cli/common.h"
#include "pcm/cli/region_options.h"
#include "pcm/system/peak_memory.h"

#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

struct Arguments {
    Common common;
    std::string tree;
    std::vector<std::string> shapes;
    RegionOptions region;
    DetectOptions options;
};

Json json_of(const Primitive& p)
{
    Json json;
    json["kind"] = traits_of(p.fit.shape.kind).name;
    json["label"] = p.label;
    json["points"] = p.points;
    json["point"] = p.fit.shape.point;
    json["axis"] = p.fit.shape.axis;
    json["radius"] = p.fit.shape.radius;
    json["rms"] = p.fit.rms;
    json["errors"] = {
        {"position", p.fit.errors.position}, {"angle", p.fit.errors.angle}, {"radius", p.fit.errors.radius}};
    return json;
}

int run(Arguments& arguments)
{
    DetectOptions& options = arguments.options;
    options.limit = arguments.region.get();
    if (!arguments.shapes.empty()) options.kinds.clear();
    for (const std::string& name : arguments.shapes) options.kinds.push_back(*shape_kind(name));
    options.progress = console_progress(arguments.common);
    const DetectReport found = detect_primitives(Tree::open(arguments.tree), options);
    end_progress(arguments.common);
    if (arguments.common.json) {
        Json json;
        json["tree"] = arguments.tree;
        put_outcome(json, found.outcome);
        json["threshold"] = found.threshold;
        json["noise"] = found.noise;
        json["spacing"] = found.spacing;
        json["sample"] = found.sample;
        Json list = Json::array();
        for (const Primitive& p : found.primitives) list.push_back(json_of(p));
        json["primitives"] = std::move(list);
        std::printf("%s\n", json.dump(1).c_str());
        return finished(found.outcome);
    }
    for (const Primitive& p : found.primitives)
        std::printf("%-14s %9s points  rms %-9s %s\n", p.name.c_str(), grouped(p.points).c_str(),
                    brief(p.fit.rms).c_str(), text_of(p.fit.shape).c_str());
    for (const std::string& note : found.notes) std::printf("note: %s\n", note.c_str());
    std::printf("%zu primitives, %s of %s points in %.1f s; threshold %s, peak memory %s\n", found.primitives.size(),
                grouped(found.outcome.points_out).c_str(), grouped(found.outcome.points_in).c_str(),
                found.outcome.seconds, brief(found.threshold).c_str(), bytes_text(peak_memory_bytes()).c_str());
    return finished(found.outcome);
}

}  // namespace

Run add_detect(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    DetectOptions& detect = arguments->options;
    options.positional("tree", arguments->tree, "Tree folder, or any file of it").required();
    options.option("--shape", arguments->shapes, "Kind of shape (default: plane, cylinder and sphere)")
        .one_of({"plane", "cylinder", "sphere"})
        .one_value_each();
    options.option("--threshold", detect.threshold, "Largest distance of a point from its surface, source units")
        .positive();
    options.option("--min-points", detect.least_points, "Least number of points of a primitive (default 500)");
    options.option("--normal-angle", detect.normal_angle,
                   "Largest angle between the normals of point and surface, radians");
    options.option("--step", detect.step, "Points farther apart are not of one primitive, source units").positive();
    options.option("--seed", detect.seed, "Seed of the search (default 1)");
    arguments->region.add_to(options, "Points to look at");
    options.option("-m,--memory", detect.memory_bytes, "Memory, e.g. 512M (default 256M)").bytes();
    options.option("-t,--threads", detect.threads, "Threads (default: one per processor)");
    add_common(options, arguments->common);
    return [arguments] { return run(*arguments); };
}

}  // namespace pcm::cli
