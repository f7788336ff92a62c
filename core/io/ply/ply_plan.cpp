#include "pcm/io/ply/ply_plan.h"

#include "pcm/io/file_text.h"
#include "pcm/io/records/carried_comments.h"
#include "pcm/io/records/stored_values.h"
#include "pcm/io/unique_name.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace pcm {
namespace {

// Names that mean three components.
bool means_three(std::string_view name) { return name == attribute_name::rgb || name == attribute_name::normal; }

constexpr auto no_group = static_cast<std::size_t>(-1);

class Planner {
public:
    Planner(const std::filesystem::path& path, const PlyHeader& header, FileInfo& info)
        : path_(path), header_(header), info_(info)
    {
    }

    PlyPlan plan();

private:
    // Properties that together are one attribute: three of a colour, or as a comment describes.
    struct Group {
        Attribute attribute;
        std::size_t index = max_attributes;  // in the schema, once added
    };

    [[noreturn]] void fail(ErrorCode code, const std::string& what) const { throw Error(code, path_, what); }
    [[noreturn]] void fail_header(const std::string& what) const
    {
        fail(ErrorCode::bad_format, "the header, lines 1 to " + std::to_string(header_.lines) + ", " + what);
    }
    const PlyElement& vertices() const { return header_.elements[plan_.vertex_element]; }

    void find_vertices();
    void find_axes();
    void plan_groups();
    std::string name_of_single(const PlyProperty& property) const;
    std::size_t property_named(const std::string& name) const;
    bool are_free(std::size_t first, std::uint64_t count) const;
    bool plan_group(const std::array<const char*, 3>& members, std::string_view name);
    bool plan_carried(const CarriedAttribute& carried);
    void plan_repeated(const RepeatedFields& repeated, const std::vector<std::string>& exact);
    void add_attribute(Attribute attribute);

    const std::filesystem::path& path_;
    const PlyHeader& header_;
    FileInfo& info_;
    PlyPlan plan_;
    std::vector<Group> groups_;
    std::vector<std::size_t> group_of_;  // for each property; or no_group
    std::vector<PlyTarget> targets_;     // for each property
};

void Planner::find_vertices()
{
    const std::size_t none = header_.elements.size();
    plan_.vertex_element = none;
    for (std::size_t i = 0; i < none; ++i) {
        if (header_.elements[i].name != "vertex") continue;
        if (plan_.vertex_element != none) fail_header("has two elements 'vertex', one was expected");
        plan_.vertex_element = i;
    }
    if (plan_.vertex_element == none) {
        std::string found;
        for (std::size_t i = 0; i < std::min<std::size_t>(none, 8); ++i)
            found += (found.empty() ? "" : ", ") + quote_bytes(header_.elements[i].name);
        fail_header("has no element 'vertex', which holds the points; found " + (found.empty() ? "none" : found));
    }
}

// Marks the three properties as components of the attribute `name` if each exists once and all have the same type.
bool Planner::plan_group(const std::array<const char*, 3>& members, std::string_view name)
{
    const std::vector<PlyProperty>& properties = vertices().properties;
    std::array<std::size_t, 3> at{};
    for (std::size_t c = 0; c < 3; ++c) {
        std::size_t found = properties.size();
        for (std::size_t i = 0; i < properties.size(); ++i)
            if (!properties[i].is_list && group_of_[i] == no_group && targets_[i].kind == PlyTarget::Kind::single &&
                lower_case(properties[i].name) == members[c]) {
                if (found != properties.size()) return false;
                found = i;
            }
        if (found == properties.size()) return false;
        at[c] = found;
    }
    const ScalarType type = properties[at[0]].type;
    if (type != properties[at[1]].type || type != properties[at[2]].type) return false;
    for (std::size_t c = 0; c < 3; ++c) {
        group_of_[at[c]] = groups_.size();
        targets_[at[c]].byte = c * size_of(type);
    }
    groups_.push_back({{std::string(name), type, 3, 1, 0, {}}, max_attributes});
    return true;
}

std::size_t Planner::property_named(const std::string& name) const
{
    const std::vector<PlyProperty>& properties = vertices().properties;
    const auto has_name = [&](const PlyProperty& p) { return !p.is_list && p.name == name; };
    return static_cast<std::size_t>(std::find_if(properties.begin(), properties.end(), has_name) - properties.begin());
}

// Scalars that are not coordinates and belong to nothing yet.
bool Planner::are_free(std::size_t first, std::uint64_t count) const
{
    const std::vector<PlyProperty>& properties = vertices().properties;
    if (count > properties.size() - first) return false;
    for (std::size_t k = first; k < first + count; ++k)
        if (properties[k].is_list || targets_[k].kind != PlyTarget::Kind::single || group_of_[k] != no_group)
            return false;
    return true;
}

// Marks the properties that a comment joins to one attribute, if they agree with the comment. Returns whether they do.
bool Planner::plan_carried(const CarriedAttribute& carried)
{
    const std::vector<PlyProperty>& properties = vertices().properties;
    const Attribute& attribute = carried.attribute;
    const std::size_t first = property_named(carried.field);
    const bool restored = first < properties.size() && can_restore(attribute, properties[first].type, carried.step);
    const bool halves = !restored && (attribute.type == ScalarType::i64 || attribute.type == ScalarType::u64);
    const std::uint64_t count = std::uint64_t{attribute.components} * (halves ? 2 : 1);
    bool fits = are_free(first, count);
    for (std::size_t k = 0; fits && k < count; ++k) {
        const ScalarType type = properties[first + k].type;
        fits = halves     ? type == ScalarType::u32 || type == ScalarType::i32
               : restored ? type == properties[first].type
                          : type == attribute.type && carried.step == 0;
    }
    if (!fits) {
        info_.notes.push_back("a comment about the attribute '" + attribute.name +
                              "' is ignored: the properties do not agree with it");
        return false;
    }
    for (std::size_t k = 0; k < count; ++k) {
        PlyTarget& target = targets_[first + k];
        group_of_[first + k] = groups_.size();
        target.byte = k * size_of(restored ? attribute.type : properties[first + k].type);
        if (!restored) continue;
        target.kind = PlyTarget::Kind::restored;
        target.step = carried.step;
    }
    groups_.push_back({attribute, max_attributes});
    return true;
}

// Leaves out the properties that repeat an attribute, if that attribute is there.
void Planner::plan_repeated(const RepeatedFields& repeated, const std::vector<std::string>& exact)
{
    const std::size_t first = property_named(repeated.field);
    if (std::find(exact.begin(), exact.end(), repeated.exact) == exact.end() || !are_free(first, repeated.count)) {
        info_.notes.push_back("a comment about the properties from '" + printable_name(repeated.field) +
                              "' on is ignored: the properties do not agree with it");
        return;
    }
    for (std::size_t k = first; k < first + repeated.count; ++k) targets_[k].kind = PlyTarget::Kind::skipped;
}

void Planner::add_attribute(Attribute attribute)
{
    if (info_.schema.size() == max_attributes)
        fail(ErrorCode::unsupported, "the vertices have more than " + std::to_string(max_attributes) + " properties");
    attribute.name = unique_name(info_.schema, attribute.name);
    info_.schema.add(std::move(attribute));
}

void Planner::find_axes()
{
    const std::vector<PlyProperty>& properties = vertices().properties;
    std::array<bool, 3> have{};
    for (std::size_t i = 0; i < properties.size(); ++i) {
        const std::string name = lower_case(properties[i].name);
        if (properties[i].is_list || name.size() != 1 || name[0] < 'x' || name[0] > 'z') continue;
        const int axis = name[0] - 'x';
        if (std::exchange(have[static_cast<std::size_t>(axis)], true))
            fail_header("gives the vertices two properties '" + name + "'");
        targets_[i].kind = PlyTarget::Kind::axis;
        targets_[i].index = static_cast<std::size_t>(axis);
    }
    for (std::size_t a = 0; a < 3; ++a)
        if (!have[a]) fail_header("gives the vertices no property '" + std::string(1, "xyz"[a]) + "'");
}

// The attribute's name for a property that belongs to no group.
std::string Planner::name_of_single(const PlyProperty& property) const
{
    const auto has_scalar = [&](std::string_view name) {
        return std::any_of(vertices().properties.begin(), vertices().properties.end(),
                           [&](const PlyProperty& p) { return !p.is_list && p.name == name; });
    };
    std::string name = property.name;
    if (means_three(name)) name += "_scalar";
    if (name == "scalar_intensity" && !has_scalar(attribute_name::intensity)) name = attribute_name::intensity;
    // A name that a group will need later is not free.
    const auto needed = [&](const Group& group) { return group.attribute.name == name; };
    while (std::any_of(groups_.begin(), groups_.end(), needed)) name += "_scalar";
    return name;
}

void Planner::plan_groups()
{
    const Carried carried = read_carried_comments(header_.comments, info_.notes);
    info_.metadata = carried.metadata;
    std::vector<std::string> exact;
    for (const CarriedAttribute& attribute : carried.attributes)
        if (plan_carried(attribute)) exact.push_back(attribute.field);
    for (const RepeatedFields& repeated : carried.repeated) plan_repeated(repeated, exact);

    using Names = std::array<const char*, 3>;
    for (const Names& members :
         {Names{"red", "green", "blue"}, Names{"diffuse_red", "diffuse_green", "diffuse_blue"}, Names{"r", "g", "b"}})
        if (plan_group(members, attribute_name::rgb)) break;
    for (const Names& members : {Names{"nx", "ny", "nz"}, Names{"normal_x", "normal_y", "normal_z"}})
        if (plan_group(members, attribute_name::normal)) break;
}

PlyPlan Planner::plan()
{
    find_vertices();
    const std::vector<PlyProperty>& properties = vertices().properties;
    targets_.assign(properties.size(), {});
    group_of_.assign(properties.size(), no_group);
    find_axes();
    plan_groups();

    bool all_f32 = true;
    for (std::size_t i = 0; i < properties.size(); ++i) {
        const PlyProperty& property = properties[i];
        if (property.is_list) {
            info_.notes.push_back("the list '" + property.name + "' of the vertices is ignored");
            continue;
        }
        PlyTarget target = targets_[i];
        target.type = property.type;
        target.offset = plan_.record_bytes;
        plan_.record_bytes += size_of(property.type);
        if (target.kind == PlyTarget::Kind::axis) {
            all_f32 = all_f32 && property.type == ScalarType::f32;
        } else if (group_of_[i] != no_group) {
            Group& group = groups_[group_of_[i]];
            if (group.index == max_attributes) {
                group.index = info_.schema.size();
                if (means_three(group.attribute.name) && group.attribute.components != 3)
                    group.attribute.name += "_scalar";
                add_attribute(group.attribute);
            }
            target.index = group.index;
        } else if (target.kind == PlyTarget::Kind::single) {
            target.index = info_.schema.size();
            add_attribute({name_of_single(property), property.type, 1, 1, 0, {}});
        }
        plan_.targets.push_back(target);
    }
    info_.position_type = all_f32 ? ScalarType::f32 : ScalarType::f64;
    info_.points = vertices().count;
    return std::move(plan_);
}

}  // namespace

PlyPlan plan_ply(const std::filesystem::path& path, const PlyHeader& header, FileInfo& info)
{
    return Planner(path, header, info).plan();
}

}  // namespace pcm
