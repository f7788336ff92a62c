#include "pcm/cli/camera_options.h"
#include "pcm/cli/common.h"
#include "pcm/cli/region_options.h"
#include "pcm/pick/describe_point.h"
#include "pcm/pick/point_picker.h"
#include "pcm/point_cloud.h"
#include "pcm/system/error.h"

#include <cmath>
#include <cstdio>
#include <memory>

namespace pcm::cli {
namespace {

constexpr double default_pixel_angle = 0.05;  // degrees: about that of a picture 1000 pixels high

struct Arguments {
    Common common;
    std::string tree, size = "1280x720";
    std::vector<double> ray, at;
    std::optional<double> pixel_angle, pixel_size;
    CameraOptions camera;
    RegionOptions limits;
    PickOptions options;
};

[[noreturn]] void refuse(const std::string& what, const std::string& hint)
{
    throw Error(ErrorCode::invalid_argument, {}, what, hint);
}

PickRay ray_of(const Arguments& arguments, const std::shared_ptr<PointCloud>& cloud)
{
    const Box3d box = cloud->info().bounds();
    if (!arguments.ray.empty()) {
        if (arguments.camera.given() || !arguments.at.empty())
            refuse("--ray and a camera or --at were both given", "give one of them");
        if (arguments.pixel_angle && (!(*arguments.pixel_angle > 0) || !(*arguments.pixel_angle < 90)))
            refuse("--pixel-angle " + exact(*arguments.pixel_angle) + " is not between 0 and 90 degrees", "");
        const auto& r = arguments.ray;
        const double angle = arguments.pixel_angle.value_or(arguments.pixel_size ? 0 : default_pixel_angle);
        return PickRay::along({r[0], r[1], r[2]}, {r[3], r[4], r[5]}, arguments.pixel_size.value_or(0),
                              std::tan(angle * pi / 180));
    }
    if (arguments.at.empty()) refuse("neither --ray nor --at was given", "give a ray, or a pixel of a view");
    if (arguments.pixel_angle || arguments.pixel_size)
        refuse("--pixel-angle and --pixel-size belong to --ray", "the size of a view's pixel follows from its camera");
    const PictureSize size = parse_size(arguments.size);
    const Camera camera =
        view_of(arguments.camera.frame({cloud}, box, size), box.centre(), box, size.width, size.height);
    const auto ray = PickRay::through(camera, arguments.at[0], arguments.at[1]);
    if (!ray)
        refuse("this camera shows nothing at the pixel " + exact(arguments.at[0]) + " " + exact(arguments.at[1]), "");
    return *ray;
}

// A number where the text is one; else, as for NaN, the text.
Json value_of(const std::string& text)
{
    Json value = Json::parse(text, nullptr, false);
    return value.is_number() ? value : Json(text);
}

void report_json(const Arguments& arguments, const PickResult& result, const PointDescription* point)
{
    Json json;
    json["tree"] = arguments.tree;
    put_outcome(json, result.outcome);
    json["points_compared"] = result.outcome.points_in;
    json["chunks"] = result.chunks;
    json["point"] = Json();
    if (point) {
        Json attributes = Json::object();
        for (const DescribedAttribute& attribute : point->attributes) {
            Json values = Json::array();
            for (const std::string& value : attribute.values) values.push_back(value_of(value));
            attributes[attribute.name] = values.size() == 1 ? values[0] : values;
        }
        json["point"] = {{"node", result.hit->node},
                         {"index", result.hit->index},
                         {"position", Json::array({point->position[0], point->position[1], point->position[2]})},
                         {"along", result.hit->along},
                         {"beside", result.hit->beside},
                         {"depth", result.hit->depth},
                         {"level", point->level},
                         {"spacing", point->spacing},
                         {"grid_step", point->grid_step},
                         {"attributes", attributes}};
    }
    print_json(json);
}

void print_text(const PickResult& result, const PointDescription* point, const PointCloud& cloud)
{
    if (point) {
        const auto line = [](const std::string& name, const std::string& value) {
            std::printf("%-24s %s\n", name.c_str(), value.c_str());
        };
        const auto& text = point->position_text;
        line("position", text[0] + " " + text[1] + " " + text[2]);
        line("point", std::to_string(result.hit->index) + " of node " + std::to_string(result.hit->node));
        line("spacing", brief(point->spacing));
        line("grid step", exact(point->grid_step));
        for (const DescribedAttribute& attribute : point->attributes) line(attribute.name, attribute.text());
        std::printf("%s along the ray and %s beside it, in %s; exact\n", brief(result.hit->along).c_str(),
                    brief(result.hit->beside).c_str(), time_text(result.outcome.seconds).c_str());
    } else {
        std::printf("no point there, in %s; exact\n%s\n", time_text(result.outcome.seconds).c_str(),
                    extent_text(cloud.info().bounds()).c_str());
    }
}

int pick(const Arguments& arguments)
{
    const auto cloud = PointCloud::open(arguments.tree);
    PickOptions options = arguments.options;
    const Selection limits = arguments.limits.get();
    options.where = limits.where;
    options.clips = limits.clips;
    const auto progress = console_progress(arguments.common);  // Ctrl-C
    options.cancelled = [&] { return !progress({}); };
    PointPicker picker(cloud->cache());
    const PickResult result = picker.exact(ray_of(arguments, cloud), options);
    std::optional<PointDescription> point;
    if (result.hit) point = describe_point(cloud->cache(), picker.sizes(), result.hit->node, result.hit->index);
    end_progress(arguments.common);
    if (arguments.common.json)
        report_json(arguments, result, point ? &*point : nullptr);
    else
        print_text(result, point ? &*point : nullptr, *cloud);
    return 0;
}

}  // namespace

Run add_pick(Options& options)
{
    auto arguments = std::make_shared<Arguments>();
    options.positional("tree", arguments->tree, "Tree folder, or any file of it").required();
    const char* group = "Pixel of a view (default camera: as that of pcmlab render)";
    options
        .option("--at", arguments->at,
                "Place x y in the picture: pixels from its upper left corner, right and down: --at 640 360")
        .values(2)
        .group(group);
    options.option("--size", arguments->size, "Width and height of the picture, pixels: --size 1920x1080")
        .show_default()
        .group(group);
    arguments->camera.add_to(options, group);
    group = "Or a ray";
    options
        .option("--ray", arguments->ray,
                "From ox oy oz in the direction dx dy dz, source coordinates: --ray 1 2 100 0 0 -1")
        .values(6)
        .group(group);
    options.option("--pixel-angle", arguments->pixel_angle, "Angle that a pixel sees, degrees (default 0.05)")
        .group(group);
    options
        .option("--pixel-size", arguments->pixel_size,
                "Size of a pixel where the ray starts, source units (default 0; with it, the angle is 0 unless given)")
        .group(group);
    group = "Points";
    options
        .option("--tolerance", arguments->options.tolerance_px,
                "How far beside a point one may click, pixels (default 4)")
        .group(group);
    options
        .option("--radius-scale", arguments->options.size_scale,
                "Radii of splats for sizes of points (default 1.25; 0: squares of a few pixels)")
        .group(group);
    arguments->limits.add_limits_to(options, group);
    add_common(options, arguments->common);
    return [arguments] { return pick(*arguments); };
}

}  // namespace pcm::cli
