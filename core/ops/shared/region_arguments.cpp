#include "pcm/ops/shared/region_arguments.h"

#include "pcm/system/error.h"

namespace pcm::ops {
namespace {

struct RegionShape {
    const char* key;
    const char* name;  // in texts of regions
    const char* label;
    std::size_t least, most;  // numbers
    bool is_common;           // else in --help-all
    const char* help;
};

constexpr RegionShape region_shapes[] = {
    {"sphere", "sphere", "Sphere", 4, 4, true, "Points in the sphere cx cy cz radius: --sphere 1 2 3 0.5"},
    {"oriented_box", "oriented-box", "Oriented box", 7, 12, false,
     "Points in the box with centre cx cy cz and half sizes hx hy hz, rotated about z by an angle in degrees, or along "
     "the axes ux uy uz vx vy vz"},
    {"ray", "ray", "Ray", 7, 8, false,
     "Points in the cylinder from ox oy oz along dx dy dz with a radius and, optionally, a length: --ray 0 0 9 0 0 -1 "
     "0.2"},
    {"cone", "cone", "Cone", 7, 8, false,
     "Points in the cone from ax ay az along dx dy dz with a half angle in degrees and, optionally, a length: --cone 0 "
     "0 9 0 0 -1 15"},
    {"frustum", "frustum", "Frustum", 10, 13, false,
     "Points seen from ex ey ez towards tx ty tz, with the vertical angle of view in degrees, width over height, near "
     "and far distance, and optionally the direction that is up, 0 0 1 where it is left out"},
    {"planes", "planes", "Planes", 7, 259, false,
     "Points on the inner side of planes: a centre cx cy cz, then nx ny nz offset for each plane, where "
     "n.(p-c)+offset>=0 is inside: --planes 5 5 0 0 0 1 2 (above z = -2)"},
    {"polygon", "polygon", "Polygon", 6, 2000000, true,
     "Points in the polygon with the corners x0 y0 x1 y1 x2 y2 ... in plan, at any height; concave ones are fine, and "
     "a part that the border goes around twice is outside"},
};

}  // namespace

void RegionArguments::declare(Arguments& arguments, const std::string& group)
{
    arguments.add("box", box_)
        .count(6)
        .group(group)
        .label("Box")
        .without("no limit")
        .help("Points in the box x0 y0 z0 x1 y1 z1, source coordinates, faces included: 0 0 0 9 9 9");
    for (const RegionShape& shape : region_shapes) {
        Argument& argument = arguments.add(shape.key, shapes_[shape.name])
                                 .as(ValueKind::numbers)
                                 .count(shape.least, shape.most)
                                 .only(Face::command)
                                 .group(group)
                                 .label(shape.label)
                                 .help(shape.help);
        if (!shape.is_common) argument.advanced();
    }
    arguments.add("region", region_)
        .group(group)
        .label("Region")
        .without("no limit")
        .help(
            "Points in a region in words, such as \"sphere 1 2 3 0.5\": box, sphere, oriented-box, ray, cone, frustum, "
            "planes or polygon with its numbers");
    declare_limits(arguments, group);
}

void RegionArguments::declare_limits(Arguments& arguments, const std::string& group)
{
    arguments.add("clip", clips_)
        .as(ValueKind::texts)
        .group(group)
        .label("Clip")
        .without("no limit")
        .advanced()
        .help(
            "Only points in this region, such as \"box 0 0 0 9 9 9\" or \"sphere 1 2 3 0.5\"; of several clips, all "
            "must hold");
    arguments.add("clip_outside", clips_outside_)
        .as(ValueKind::texts)
        .group(group)
        .label("Clip outside")
        .without("no limit")
        .advanced()
        .help("Only points that are not in this region; may be given several times");
    arguments.add("where", where_)
        .as(ValueKind::texts)
        .group(group)
        .label("Where")
        .without("no limit")
        .help(
            "Points that satisfy a condition, such as classification=2,6 or \"intensity>=100\" or z=100.. or "
            "gps_time=100..200 or rgb[0]!=0; of several conditions, all");
}

Selection RegionArguments::get() const
{
    Selection selection;
    if (!box_.empty()) selection.box = Box3d{{box_[0], box_[1], box_[2]}, {box_[3], box_[4], box_[5]}};
    selection.region = region();
    refuse_impossible_box(selection);
    for (const std::string& text : clips_) selection.clips.push_back({parse_region(text), false});
    for (const std::string& text : clips_outside_) selection.clips.push_back({parse_region(text), true});
    for (const std::string& condition : where_) selection.where.push_back(parse_condition(condition));
    return selection;
}

std::optional<Region> RegionArguments::region() const
{
    std::optional<Region> region;
    std::string first;
    const auto take = [&](const std::string& name, const std::string& text) {
        if (region)
            throw Error(ErrorCode::invalid_argument, {}, "--" + first + " and --" + name + " were both given",
                        "give one region; a --box may be added");
        first = name;
        region = parse_region(text);
    };
    for (const auto& [name, words] : shapes_) {
        if (words.empty()) continue;
        std::string text = name;
        for (const std::string& word : words) text += " " + word;
        take(name, text);
    }
    if (!region_.empty()) take("region", region_);
    return region;
}

}  // namespace pcm::ops
