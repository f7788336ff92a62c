#include "pcm/io/pcd/pcd_plan.h"

#include "pcm/io/file_text.h"
#include "pcm/io/records/carried_comments.h"
#include "pcm/io/records/line_words.h"
#include "pcm/io/records/stored_values.h"
#include "pcm/io/unique_name.h"
#include "pcm/system/error.h"

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace pcm {
namespace {

constexpr auto no_field = static_cast<std::size_t>(-1);

class Planner {
public:
    Planner(const std::filesystem::path& path, const PcdHeader& header, FileInfo& info)
        : path_(path), header_(header), info_(info)
    {
    }

    PcdPlan plan();

private:
    [[noreturn]] void fail(ErrorCode code, const std::string& what) const { throw Error(code, path_, what); }

    void plan_axes();
    void plan_group(const std::array<const char*, 3>& members, std::string_view name);
    void plan_field(std::size_t field);
    std::size_t add_attribute(Attribute attribute);
    void restore(const CarriedAttribute& carried);
    void find_repeated(const Carried& carried);
    void plan_shift(const Carried& carried);

    const std::filesystem::path& path_;
    const PcdHeader& header_;
    FileInfo& info_;
    PcdPlan plan_;
    std::set<std::size_t> repeated_;  // fields
};

std::size_t Planner::add_attribute(Attribute attribute)
{
    if (info_.schema.size() == max_attributes)
        fail(ErrorCode::unsupported, "a point has more than " + std::to_string(max_attributes) + " attributes");
    attribute.name = unique_name(info_.schema, attribute.name);
    info_.schema.add(std::move(attribute));
    return info_.schema.size() - 1;
}

void Planner::plan_axes()
{
    std::array<bool, 3> have{};
    bool all_f32 = true;
    for (std::size_t i = 0; i < header_.fields.size(); ++i) {
        const PcdField& field = header_.fields[i];
        const std::string name = lower_case(field.name);
        if (name.size() != 1 || name[0] < 'x' || name[0] > 'z') continue;
        const auto axis = static_cast<std::size_t>(name[0] - 'x');
        if (std::exchange(have[axis], true)) fail(ErrorCode::bad_format, "the header has two fields '" + name + "'");
        if (field.count != 1)
            fail(ErrorCode::bad_format,
                 "the field '" + name + "' has COUNT " + std::to_string(field.count) + ", expected 1");
        plan_.targets[i].kind = PcdTarget::Kind::axis;
        plan_.targets[i].index = axis;
        all_f32 = all_f32 && field.type == ScalarType::f32;
    }
    for (std::size_t a = 0; a < 3; ++a)
        if (!have[a]) fail(ErrorCode::bad_format, "the header has no field '" + std::string(1, "xyz"[a]) + "'");
    info_.position_type = all_f32 ? ScalarType::f32 : ScalarType::f64;
}

// Joins the three fields to one attribute if each exists once, with COUNT 1, and all have the same type.
void Planner::plan_group(const std::array<const char*, 3>& members, std::string_view name)
{
    if (info_.schema.find(name)) return;
    const std::vector<PcdField>& fields = header_.fields;
    std::array<std::size_t, 3> at{no_field, no_field, no_field};
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < fields.size(); ++i) {
            if (lower_case(fields[i].name) != members[c] || repeated_.count(i)) continue;
            if (at[c] != no_field || fields[i].count != 1) return;
            at[c] = i;
        }
    for (const std::size_t i : at)
        if (i == no_field || fields[i].type != fields[at[0]].type || plan_.targets[i].kind != PcdTarget::Kind::none)
            return;
    const ScalarType type = fields[at[0]].type;
    const std::size_t attribute = add_attribute({std::string(name), type, 3, 1, 0, {}});
    for (std::size_t c = 0; c < 3; ++c) {
        plan_.targets[at[c]].kind = PcdTarget::Kind::scalars;
        plan_.targets[at[c]].index = attribute;
        plan_.targets[at[c]].byte = c * size_of(type);
    }
}

void Planner::plan_field(std::size_t i)
{
    const PcdField& field = header_.fields[i];
    PcdTarget& target = plan_.targets[i];
    const std::string name = lower_case(field.name);
    if ((name == "rgb" || name == "rgba") && field.count == 1 && size_of(field.type) == 4 &&
        !info_.schema.find(attribute_name::rgb)) {
        target.kind = PcdTarget::Kind::packed_colour;
        target.index = add_attribute({std::string(attribute_name::rgb), ScalarType::u8, 3, 1, 0, {}});
        if (name == "rgba") target.alpha = add_attribute({"alpha", ScalarType::u8, 1, 1, 0, {}});
        return;
    }
    std::string attribute = pcd_attribute_name(field.name);
    if ((attribute == attribute_name::rgb || attribute == attribute_name::normal) && field.count != 3)
        attribute += "_scalar";  // these names mean three components
    target.kind = PcdTarget::Kind::scalars;
    target.index = add_attribute({attribute, field.type, field.count, 1, 0, {}});
}

// Applies a comment about an attribute, if the fields agree with it.
void Planner::restore(const CarriedAttribute& carried)
{
    const Attribute& attribute = carried.attribute;
    std::optional<std::size_t> at;
    for (std::size_t i = 0; i < plan_.targets.size(); ++i)
        if (header_.fields[i].name == carried.field && (plan_.targets[i].kind == PcdTarget::Kind::scalars ||
                                                        plan_.targets[i].kind == PcdTarget::Kind::packed_colour))
            at = i;
    const bool means_three = attribute.name == attribute_name::rgb || attribute.name == attribute_name::normal;
    const auto fits = [&] {
        if (!at || (means_three && attribute.components != 3)) return false;
        const PcdTarget& target = plan_.targets[*at];
        const Attribute& found = info_.schema[target.index];
        if (found.components != attribute.components) return false;
        if (carried.step == 0 && found.type == attribute.type) return true;
        return target.kind == PcdTarget::Kind::packed_colour ? can_restore(attribute, found.type, carried.step)
                                                             : !carried.step && can_restore(attribute, found.type, 0);
    };
    if (!fits()) {
        info_.notes.push_back("a comment about the attribute '" + attribute.name +
                              "' is ignored: no field agrees with it");
        return;
    }
    const std::size_t index = plan_.targets[*at].index;
    const ScalarType type = info_.schema[index].type;
    for (PcdTarget& target : plan_.targets) {
        if (target.index != index || type == attribute.type) continue;
        if (target.kind == PcdTarget::Kind::packed_colour) target.step = carried.step;
        if (target.kind != PcdTarget::Kind::scalars) continue;
        target.kind = PcdTarget::Kind::restored;
        target.byte = target.byte / size_of(type) * size_of(attribute.type);
    }
    Schema schema;
    for (std::size_t i = 0; i < info_.schema.size(); ++i) {
        if (i != index) {
            Attribute other = info_.schema[i];
            if (other.name == attribute.name) other.name = unique_name(info_.schema, other.name);
            schema.add(std::move(other));
        } else {
            schema.add(attribute);
        }
    }
    info_.schema = std::move(schema);
}

// The fields that repeat an attribute, where the field that holds it exactly agrees with its comment.
void Planner::find_repeated(const Carried& carried)
{
    const std::vector<PcdField>& fields = header_.fields;
    const auto named = [&](const std::string& name) {
        const auto has_name = [&](const PcdField& field) { return field.name == name; };
        return static_cast<std::size_t>(std::find_if(fields.begin(), fields.end(), has_name) - fields.begin());
    };
    for (const RepeatedFields& repeated : carried.repeated) {
        const std::size_t field = named(repeated.field), exact = named(repeated.exact);
        const auto is_exact = [&](const CarriedAttribute& c) {
            return c.field == repeated.exact && c.step == 0 && fields[exact].type == c.attribute.type &&
                   fields[exact].count == c.attribute.components;
        };
        bool fits = field < fields.size() && exact < fields.size() && repeated.count <= fields.size() - field &&
                    std::any_of(carried.attributes.begin(), carried.attributes.end(), is_exact);
        for (std::size_t k = field; fits && k < field + repeated.count; ++k)
            fits = k != exact && plan_.targets[k].kind == PcdTarget::Kind::none;
        if (fits)
            for (std::size_t k = field; k < field + repeated.count; ++k) repeated_.insert(k);
        else
            info_.notes.push_back("a comment about the field '" + printable_name(repeated.field) +
                                  "' is ignored: no field agrees with it");
    }
}

// Floats relative to a shift, which VIEWPOINT has too: where it has another, somebody has moved the points.
void Planner::plan_shift(const Carried& carried)
{
    if (!carried.shift) return;
    LineWords words(header_.viewpoint);
    std::string_view word;
    bool same = info_.position_type == ScalarType::f32;
    const bool moved = *carried.shift != Vec3d{0, 0, 0};
    for (const double wanted : *carried.shift) {
        double found = 0;
        if (moved)
            same = words.next_number(ScalarType::f64, reinterpret_cast<std::byte*>(&found), word) && found == wanted &&
                   same;
    }
    if (!same) {
        info_.notes.emplace_back(
            "a comment about a shift of the positions is ignored: " +
            std::string(info_.position_type == ScalarType::f32 ? "VIEWPOINT has another" : "they are not floats"));
        return;
    }
    plan_.shift = carried.shift;
    plan_.grid = carried_grid(carried.metadata);
    plan_.viewpoint_is_shift = moved;
    info_.position_type = ScalarType::f64;
}

PcdPlan Planner::plan()
{
    const std::vector<PcdField>& fields = header_.fields;
    plan_.targets.assign(fields.size(), {});
    std::size_t offset = 0;
    for (std::size_t i = 0; i < fields.size(); ++i) {
        plan_.targets[i].type = fields[i].type;
        plan_.targets[i].bytes = static_cast<std::size_t>(fields[i].bytes());
        plan_.targets[i].offset = offset;
        offset += plan_.targets[i].bytes;
    }
    plan_.record_bytes = offset;
    plan_axes();
    const Carried carried = read_carried_comments(header_.comments, info_.notes);
    find_repeated(carried);

    using Names = std::array<const char*, 3>;
    const auto begins = [&](std::size_t field, const Names& members) {
        const std::string name = lower_case(fields[field].name);
        return std::find(members.begin(), members.end(), name) != members.end();
    };
    // In the order of the fields, so that attributes come in the order of the file.
    for (std::size_t i = 0; i < fields.size(); ++i) {
        if (repeated_.count(i)) continue;
        for (const Names& members : {Names{"red", "green", "blue"}, Names{"r", "g", "b"}})
            if (plan_.targets[i].kind == PcdTarget::Kind::none && begins(i, members))
                plan_group(members, attribute_name::rgb);
        for (const Names& members : {Names{"normal_x", "normal_y", "normal_z"}, Names{"nx", "ny", "nz"}})
            if (plan_.targets[i].kind == PcdTarget::Kind::none && begins(i, members))
                plan_group(members, attribute_name::normal);
        if (plan_.targets[i].kind == PcdTarget::Kind::none && !fields[i].is_padding()) plan_field(i);
    }
    info_.metadata = carried.metadata;
    for (const CarriedAttribute& attribute : carried.attributes) restore(attribute);
    plan_shift(carried);
    return std::move(plan_);
}

}  // namespace

PcdPlan plan_pcd(const std::filesystem::path& path, const PcdHeader& header, FileInfo& info)
{
    return Planner(path, header, info).plan();
}

}  // namespace pcm
