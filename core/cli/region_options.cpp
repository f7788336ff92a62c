#include "pcm/cli/region_options.h"

#include "pcm/system/error.h"

namespace pcm::cli {

void RegionOptions::add_to(Options& options, const char* group)
{
    options
        .option("--box", box_,
                "Points in the box x0 y0 z0 x1 y1 z1, source coordinates, faces included: --box 0 0 0 9 9 9")
        .values(6)
        .group(group);
    const auto add = [&](const char* name, int least, int most, const char* help) {
        options.option(std::string("--") + name, given_[name], help)
            .values(least, most)
            .shown_as("NUMBER")
            .group(group);
    };
    add("sphere", 4, 4, "Points in the sphere cx cy cz radius: --sphere 1 2 3 0.5");
    add("oriented-box", 7, 12,
        "Points in the box with centre cx cy cz and half sizes hx hy hz, rotated about z by an angle in degrees, or "
        "along "
        "the axes ux uy uz vx vy vz");
    add("ray", 7, 8,
        "Points in the cylinder from ox oy oz along dx dy dz with a radius and, optionally, a length: --ray 0 0 9 0 0 "
        "-1 0.2");
    add("cone", 7, 8,
        "Points in the cone from ax ay az along dx dy dz with a half angle in degrees and, optionally, a length: "
        "--cone 0 0 9 0 0 -1 15");
    add("frustum", 10, 13,
        "Points seen from ex ey ez towards tx ty tz, with the vertical angle of view in degrees, width over height, "
        "near "
        "and far distance, and optionally the direction that is up (default 0 0 1)");
    add("planes", 7, 259,
        "Points on the inner side of planes: a centre cx cy cz, then nx ny nz offset for each plane, where "
        "n.(p-c)+offset>=0 is inside: --planes 5 5 0 0 0 1 2 (above z = -2)");
    add("polygon", 6, 2000000,
        "Points in the polygon with the corners x0 y0 x1 y1 x2 y2 ... in plan, at any height; concave ones are fine, "
        "and "
        "a part that the border goes around twice is outside");
    options.option("--region", given_["region"], "One of these regions in words, such as \"sphere 1 2 3 0.5\"")
        .values(1)
        .one_value_each()
        .group(group);
    add_limits_to(options, group);
}

void RegionOptions::add_limits_to(Options& options, const char* group)
{
    options
        .option("--clip", clips_,
                "Of these, only points in this region, such as \"box 0 0 0 9 9 9\"; of several clips, all must hold")
        .one_value_each()
        .group(group);
    options.option("--clip-outside", clips_outside_, "Of these, only points that are not in this region; repeatable")
        .one_value_each()
        .group(group);
    options
        .option("--where", where_,
                "Points that satisfy a condition, such as classification=2,6 or \"intensity>=100\" or "
                "gps_time=100..200 or rgb[0]!=0; of several conditions, all")
        .one_value_each()
        .group(group);
}

Selection RegionOptions::get() const
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

std::optional<Region> RegionOptions::region() const
{
    std::optional<Region> region;
    std::string first;
    for (const auto& [name, words] : given_) {
        if (words.empty()) continue;
        if (region)
            throw Error(ErrorCode::invalid_argument, {}, "--" + first + " and --" + name + " were both given",
                        "give one region; a --box may be added");
        first = name;
        std::string text = name == "region" ? "" : name;
        for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
        region = parse_region(text);
    }
    return region;
}

}  // namespace pcm::cli
