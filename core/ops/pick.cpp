// The point that a view shows at a pixel, or that a ray meets, and all its attributes.
#include "pcm/ops/shared/camera_arguments.h"
#include "pcm/ops/shared/region_arguments.h"
#include "pcm/ops/table.h"
#include "pcm/pick/describe_point.h"
#include "pcm/pick/point_picker.h"
#include "pcm/point_cloud.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <cmath>
#include <memory>

namespace pcm::ops {
namespace {

constexpr double default_pixel_angle = 0.05;  // degrees: about that of a picture 1000 pixels high

[[noreturn]] void refuse_pick(const std::string& what, const std::string& hint)
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

// A number where the text is one; else, as for NaN, the text.
Json json_of_text(const std::string& text)
{
    Json value = Json::parse(text, nullptr, false);
    return value.is_number() ? value : Json(text);
}

void put_point(Result& result, const PickResult& found, const PointDescription* point, const PointCloud& cloud)
{
    result.outcome = found.outcome;
    result.accuracy = exact_answer();
    Json& json = result.values;
    json["points_compared"] = found.outcome.points_in;
    json["chunks"] = found.chunks;
    json["point"] = Json();
    if (!point) {
        result.line("no point there, in " + time_text(found.outcome.seconds) + "; exact");
        result.line(extent_text(cloud.info().bounds()));
        return;
    }
    Json attributes = Json::object();
    for (const DescribedAttribute& attribute : point->attributes) {
        Json values = Json::array();
        for (const std::string& value : attribute.values) values.push_back(json_of_text(value));
        attributes[attribute.name] = values.size() == 1 ? values[0] : values;
    }
    json["point"] = {{"node", found.hit->node},
                     {"index", found.hit->index},
                     {"position", Json::array({point->position[0], point->position[1], point->position[2]})},
                     {"along", found.hit->along},
                     {"beside", found.hit->beside},
                     {"depth", found.hit->depth},
                     {"level", point->level},
                     {"spacing", point->spacing},
                     {"grid_step", point->grid_step},
                     {"attributes", attributes}};
    const auto line = [&](const std::string& name, const std::string& value) {
        result.print("%-24s %s", name.c_str(), value.c_str());
    };
    const auto& text = point->position_text;
    line("position", text[0] + " " + text[1] + " " + text[2]);
    line("point", std::to_string(found.hit->index) + " of node " + std::to_string(found.hit->node));
    line("spacing", brief(point->spacing));
    line("grid step", exact(point->grid_step));
    for (const DescribedAttribute& attribute : point->attributes) line(attribute.name, attribute.text());
    result.line(brief(found.hit->along) + " along the ray and " + brief(found.hit->beside) + " from it, in " +
                time_text(found.outcome.seconds) + "; exact");
}

class Pick : public Operation {
public:
    Pick()
    {
        arguments_.add("tree", tree_)
            .as(ValueKind::tree)
            .positional()
            .required()
            .help("Tree folder, or any file of it");
        const char* group = "Pixel of a view (default camera: as that of pcmlab render)";
        arguments_.add("at", at_).count(2).group(group).help(
            "Place x y in the picture: pixels from its upper left corner, right and down: --at 640 360");
        arguments_.add("size", size_).group(group).help("Width and height of the picture, pixels: --size 1920x1080");
        camera_.declare(arguments_, group);
        group = "Or a ray";
        arguments_.add("ray", ray_)
            .count(6)
            .group(group)
            .help("From ox oy oz in the direction dx dy dz, source coordinates: --ray 1 2 100 0 0 -1");
        arguments_.add("pixel_angle", pixel_angle_)
            .unit("degrees")
            .group(group)
            .help("Angle that a pixel sees")
            .without("0.05");
        arguments_.add("pixel_size", pixel_size_)
            .unit("source units")
            .group(group)
            .help("Size of a pixel where the ray starts; with it, the angle is 0 unless given")
            .without("0");
        group = "Points";
        arguments_.add("tolerance", options_.tolerance_px)
            .group(group)
            .help("Maximum distance of a click from a point");
        arguments_.add("radius_scale", options_.size_scale)
            .group(group)
            .help("Radii of splats for sizes of points; 0: squares of a few pixels");
        limits_.declare_limits(arguments_, group);
    }

    Result answer(const Context& context) override
    {
        const auto cloud = PointCloud::open(tree_);
        PickOptions options = options_;
        const Selection limits = limits_.get();
        options.where = limits.where;
        options.clips = limits.clips;
        options.cancelled = [&] { return context.progress && !context.progress({}); };
        PointPicker picker(cloud->cache());
        const PickResult found = picker.exact(ray_of(cloud), options);
        std::optional<PointDescription> point;
        if (found.hit) point = describe_point(cloud->cache(), picker.sizes(), found.hit->node, found.hit->index);
        Result result;
        result.input = {tree_};
        put_point(result, found, point ? &*point : nullptr, *cloud);
        return result;
    }

private:
    PickRay ray_of(const std::shared_ptr<PointCloud>& cloud) const
    {
        const Box3d box = cloud->info().bounds();
        if (!ray_.empty()) return given_ray();
        if (at_.empty()) refuse_pick("neither --ray nor --at was given", "give a ray, or a pixel of a view");
        if (pixel_angle_ || pixel_size_)
            refuse_pick("--pixel-angle and --pixel-size belong to --ray",
                        "the size of a view's pixel follows from its camera");
        const PictureSize size = parse_size(size_);
        const Camera camera = view_of(camera_.frame({cloud}, box, size), box.centre(), box, size.width, size.height);
        const auto ray = PickRay::through(camera, at_[0], at_[1]);
        if (!ray) refuse_pick("this camera shows nothing at the pixel " + exact(at_[0]) + " " + exact(at_[1]), "");
        return *ray;
    }

    PickRay given_ray() const
    {
        if (camera_.given() || !at_.empty())
            refuse_pick("--ray and a camera or --at were both given", "give one of them");
        if (pixel_angle_ && (!(*pixel_angle_ > 0) || !(*pixel_angle_ < 90)))
            refuse_pick("--pixel-angle " + exact(*pixel_angle_) + " is not between 0 and 90 degrees", "");
        const double angle = pixel_angle_.value_or(pixel_size_ ? 0 : default_pixel_angle);
        return PickRay::along({ray_[0], ray_[1], ray_[2]}, {ray_[3], ray_[4], ray_[5]}, pixel_size_.value_or(0),
                              std::tan(angle * pi / 180));
    }

    std::string tree_, size_ = "1280x720";
    std::vector<double> ray_, at_;
    std::optional<double> pixel_angle_, pixel_size_;
    CameraArguments camera_;
    RegionArguments limits_;
    PickOptions options_;
};

}  // namespace

Row pick_row()
{
    return {"pick",
            nullptr,
            "Pick the point that a view shows at a pixel, or that a ray meets, and list all its attributes",
            "Finds the point that a view shows at a pixel of its picture, or that a ray meets first, at full "
            "resolution, and lists its position and all its attributes.",
            0,
            nullptr,
            {{"points_compared", "count", "points", "points that were compared with the ray"},
             {"chunks", "count", "", "chunks that were read"},
             {"point", "object?", "",
              "node, index, position, along, beside, depth, level, spacing, grid_step, attributes"}},
            make<Pick>,
            {},
            always_exact};
}

}  // namespace pcm::ops
