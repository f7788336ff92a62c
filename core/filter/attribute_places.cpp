#include "pcm/filter/attribute_places.h"

#include "pcm/cloud/attribute_length.h"
#include "pcm/filter/result_attributes.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <string>
#include <string_view>

namespace pcm {

std::vector<std::size_t> AttributePlaces::written() const
{
    std::vector<std::size_t> all;
    for (const auto& place : {normal, radius, curvature, confidence, mean_distance})
        if (place) all.push_back(*place);
    return all;
}

void check_options(const NeighbourAttributeOptions& options, const std::filesystem::path& path)
{
    const auto refuse = [&](const char* what, const char* hint) {
        throw Error(ErrorCode::invalid_argument, path, what, hint);
    };
    if (!options.wanted.any()) refuse("no attribute is to be computed", "choose radii, normals or another attribute");
    if (!(options.radius_limit >= 0)) refuse("the limit of radii must be 0 or more", "");
    if (!(options.max_distance > 0)) refuse("the largest distance of a neighbour must be positive", "");
    if (options.wanted.normal) {
        if (!is_finite(options.orientation.vector)) refuse("the orientation is not finite", "");
        if (options.orientation.rule == NormalOrientation::Rule::direction &&
            largest_magnitude(options.orientation.vector) == 0)
            refuse("the direction that normals are to point to is 0 0 0", "give a direction such as 0 0 1");
    }
}

void check_scanners(const NeighbourAttributeOptions& options, const TreeInfo& info, const std::filesystem::path& path)
{
    if (!options.wanted.normal || options.orientation.rule != NormalOrientation::Rule::scanners) return;
    if (ScannerPlaces(info.metadata, info.schema).empty())
        throw Error(ErrorCode::invalid_argument, path, "the cloud does not say where its scanner stood",
                    "PTX and E57 files do; for one scan, give the scanner's position instead");
}

AttributePlaces find_places(const Tree& tree, const WantedValues& wanted, bool overwrite,
                            const std::function<std::size_t(const Attribute&)>& place_for)
{
    AttributePlaces places;
    const auto place = [&](bool is_wanted, std::string_view name, ScalarType type, std::uint32_t components,
                           const char* description) -> std::optional<std::size_t> {
        if (!is_wanted) return {};
        const Attribute attribute{std::string(name), type, components, 1, 0, description};
        // Normals and radii are what the cloud looks like: new ones are to take the place of any.
        if (name != attribute_name::normal && name != attribute_name::radius)
            check_may_write(tree, attribute, overwrite);
        return place_for(attribute);
    };
    // In the order that exports have them.
    places.normal = place(wanted.normal, attribute_name::normal, ScalarType::f32, 3, "");
    places.radius =
        place(wanted.radius, attribute_name::radius, ScalarType::f32, 1, attribute_unit::radius_description.data());
    places.curvature = place(wanted.curvature, attribute_name::curvature, ScalarType::f32, 1,
                             "share of the smallest variance among the neighbours, 0 to 1/3");
    places.confidence =
        place(wanted.confidence, attribute_name::normal_confidence, ScalarType::u8, 1,
              "0 good, 1 neighbours on a line, 2 no plane, 3 too few neighbours, 4 on two surfaces: side uncertain");
    places.mean_distance = place(wanted.mean_distance, attribute_name::mean_distance, ScalarType::f32, 1,
                                 "of the nearest neighbours, source units");
    const Schema& schema = tree.info().schema;
    const auto known = schema.find(attribute_name::normal);
    if (wanted.radius && !wanted.normal && known && schema[*known].components == 3) places.known_normal = known;
    return places;
}

bool is_consistent(const NeighbourAttributeOptions& options)
{
    return options.wanted.normal && options.orientation.rule == NormalOrientation::Rule::consistent;
}

// Where they are more than noise makes by chance.
void report_two_surfaces(std::uint64_t points, NeighbourAttributeReport& report)
{
    if (report.two_surfaces * 200 <= points) return;
    report.notes.push_back(std::to_string(report.two_surfaces) + " points (" +
                           brief(100 * static_cast<double>(report.two_surfaces) / static_cast<double>(points)) +
                           " %) lie on two surfaces nearer to each other than their points, such as both sides of a "
                           "thin plate: which side "
                           "their normals point to is a guess (normal_confidence 4)");
}

}  // namespace pcm
