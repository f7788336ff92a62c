// The radius of every point's splat from its nearest neighbours.
#include "pcm/ops/shared/attribute_report.h"
#include "pcm/ops/shared/neighbour_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/system/error.h"

namespace pcm::ops {
namespace {

enum class Device : std::uint8_t { cpu, gpu };

class Radii : public Operation {
public:
    Radii()
    {
        target_.declare_cloud(arguments_);
        options_.wanted.radius = true;
        neighbours_.neighbours = usual_radius_neighbours;
        arguments_.add("mean_distance", options_.wanted.mean_distance)
            .label("Mean distance too")
            .help("Also write the attribute mean_distance: to the neighbours, in source units");
        target_.declare_target(arguments_, "mean_distance");
        neighbours_.declare(arguments_, "that a disc covers");
        arguments_.choice("device", device_, {{"cpu", "Processor"}, {"gpu", "Graphics card"}})
            .only(Face::command)
            .label("Device")
            .help(
                "gpu: by compute shaders, which takes OpenGL 4.3 and pcmlab-render; faster only with a fast card and "
                "one or two cores");
    }

    Result answer(const Context& context) override
    {
        if (device_ == Device::gpu) return run_on_gpu(context);
        neighbours_.put_into(options_, called(context, "memory"));
        Result result = compute_attributes(context, target_, arguments_, options_);
        result.values["computed_with"] = nullptr;
        return result;
    }

private:
    Result run_on_gpu(const Context& context) const
    {
        if (options_.wanted.mean_distance || neighbours_.max_distance || neighbours_.work.threads > 0 ||
            neighbours_.flann)
            throw ArgumentError(
                "--device gpu computes exact radii and nothing else: of the options that choose what is "
                "computed and how, it takes --neighbours and --memory");
        if (!context.gpu_radii)
            throw Error(ErrorCode::unsupported, target_.tree, "several processes do not compute on graphics cards",
                        "leave out --device");
        return context.gpu_radii(
            {target_.tree, target_.choice(context.face, arguments_), neighbours_.neighbours, neighbours_.work.memory});
    }

    TargetArguments target_;
    NeighbourArguments neighbours_;
    NeighbourAttributeOptions options_;
    Device device_ = Device::cpu;
};

std::vector<ResultKey> keys()
{
    std::vector<ResultKey> keys = attribute_keys();
    keys.push_back({"computed_with", "text?", "", "renderer of the OpenGL driver; null: the processor"});
    return keys;
}

}  // namespace

Row radii_row()
{
    return {
        "radii",
        "Estimate Radii of Point Cloud Tree",
        "Compute the radius of every point's splat from its nearest neighbours",
        "Gives every point of a <b>point cloud tree</b> the radius of a disc that covers its nearest neighbours; "
        "across its normal, where the tree has normals. The result is the attribute <i>radius</i>, in a copy of the "
        "tree or in place. Works on clouds larger than memory.",
        menu::points,
        "-radii.pct",
        keys(),
        make<Radii>,
        {"neighbours"},
        always_exact};
}

}  // namespace pcm::ops
