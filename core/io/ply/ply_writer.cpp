#include "pcm/io/ply/ply_writer.h"

#include "pcm/io/file_text.h"
#include "pcm/io/ply/ply_header.h"
#include "pcm/io/records/carried_comments.h"
#include "pcm/io/records/record_encoder.h"
#include "pcm/io/records/stored_values.h"
#include "pcm/system/error.h"
#include "pcm/system/output_file.h"

#include <algorithm>
#include <set>
#include <utility>

namespace pcm {
namespace {

// The PLY properties of one attribute of the cloud, or of an axis.
struct Property {
    std::string name;
    RecordField field;
};

std::string_view ply_name(ScalarType type)
{
    switch (type) {
        case ScalarType::i8:
            return "char";
        case ScalarType::u8:
            return "uchar";
        case ScalarType::i16:
            return "short";
        case ScalarType::u16:
            return "ushort";
        case ScalarType::i32:
            return "int";
        case ScalarType::u32:
            return "uint";
        case ScalarType::f32:
            return "float";
        default:
            return "double";
    }
}

// Names with a special meaning for ply_reader.
bool has_a_meaning(const std::string& lower_name)
{
    static constexpr std::string_view names[] = {"x",
                                                 "y",
                                                 "z",
                                                 "red",
                                                 "green",
                                                 "blue",
                                                 "r",
                                                 "g",
                                                 "b",
                                                 "nx",
                                                 "ny",
                                                 "nz",
                                                 "diffuse_red",
                                                 "diffuse_green",
                                                 "diffuse_blue",
                                                 "normal_x",
                                                 "normal_y",
                                                 "normal_z",
                                                 "rgb",
                                                 "normal",
                                                 "scalar_intensity"};
    return std::find(std::begin(names), std::end(names), lower_name) != std::end(names);
}

class Plan {
public:
    Plan(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options) : options_(options)
    {
        // Checked before names are made for each of a million components.
        constexpr std::size_t shortest_line = 16;
        std::uint64_t components = 0;
        for (const Attribute& attribute : cloud.schema) components += attribute.components;
        if (components > longest_ply_header / shortest_line)
            throw Error(
                ErrorCode::invalid_argument, path,
                "a PLY header has no room for the " + std::to_string(components) + " components of the attributes");
        const ScalarType position =
            cloud.position_type == ScalarType::f32 && !cloud.grid ? ScalarType::f32 : ScalarType::f64;
        for (std::size_t a = 0; a < 3; ++a)
            properties.push_back({std::string(1, "xyz"[a]), RecordField::axis(a, position)});
        has_colours_ = cloud.schema.find(attribute_name::rgb).has_value();
        for (std::size_t i = 0; i < cloud.schema.size(); ++i) add(cloud.schema[i], i);
    }

    std::vector<Property> properties;
    Carried carried;
    std::vector<std::string> notes;

private:
    using Names = std::vector<std::string>;

    static bool is_wide(ScalarType type) { return type == ScalarType::i64 || type == ScalarType::u64; }
    static bool is_three(const Attribute& attribute, std::string_view name)
    {
        return attribute.name == name && attribute.components == 3;
    }

    void add(const Attribute& attribute, std::size_t index)
    {
        const ValueSurvey* const known = options_.survey ? options_.survey->of(index) : nullptr;
        const bool colours = is_three(attribute, attribute_name::rgb);
        StoredAs stored =
            colours ? stored_colours(attribute, known, options_.colour_bits) : stored_values(attribute, known);
        if (stored.raw() && is_wide(attribute.type) && known && known->doubles_hold) {
            stored.source = RecordField::Source::value;
            stored.type = ScalarType::f64;
        }
        const bool halves = stored.raw() && is_wide(attribute.type);
        Names names;
        bool plain = stored.raw();  // read back the same without a comment
        if (colours && !halves) {
            names = {"red", "green", "blue"};
        } else if (is_three(attribute, attribute_name::normal) && !halves) {
            names = {"nx", "ny", "nz"};
        } else if (attribute.name == attribute_name::intensity && attribute.components == 1 && has_colours_ &&
                   stored.type == ScalarType::f32) {
            // As CloudCompare calls it: MeshLab takes a float 'intensity' for a grey instead of the colour.
            names = {"scalar_intensity"};
        } else {
            names = names_of(attribute, halves, "");
            plain = plain && names.size() == 1 && names[0] == attribute.name;
        }
        add_properties(attribute, index, names, stored);
        if (halves)
            notes.push_back("PLY has no 64-bit integers: '" + attribute.name + "' is written as two properties each, " +
                            names[0] + " and " + names[1] + ", the lower and the upper 32 bits");
        if (stored.rounded && colours && options_.colour_bits) {
            notes.push_back("colours of type " + std::string(name_of(attribute.type)) + " are rounded to 8 bits");
        } else if (stored.rounded) {
            add_exact(attribute, index, names);
        } else if (!plain || attribute.scale != 1 || attribute.offset != 0 || !attribute.description.empty()) {
            carried.attributes.push_back({names[0], attribute, stored.step});
        }
    }

    // The raw numbers, after properties that have them rounded.
    void add_exact(const Attribute& attribute, std::size_t index, const Names& rounded)
    {
        StoredAs raw;
        raw.type = attribute.type;
        const bool colours = is_three(attribute, attribute_name::rgb);
        Names names{"red_exact", "green_exact", "blue_exact"};
        if (!colours || is_wide(attribute.type) ||
            used_.count(names[0]) + used_.count(names[1]) + used_.count(names[2]))
            names = names_of(attribute, is_wide(attribute.type), colours ? "_exact" : "_raw");
        add_properties(attribute, index, names, raw);
        carried.attributes.push_back({names[0], attribute, 0});
        carried.repeated.push_back({rounded[0], static_cast<std::uint32_t>(rounded.size()), names[0]});
        if (colours)
            notes.push_back("colours of type " + std::string(name_of(attribute.type)) +
                            " are written with 8 bits, which other programs show, and exactly, as " + names[0] +
                            " and so on: 8 colour bits leave the exact ones out, 16 those of 8 bits");
        else
            notes.push_back("'" + attribute.name + "' is written as values, " + rounded[0] + ", and as raw numbers, " +
                            names[0] + ", without its scale and offset");
    }

    void add_properties(const Attribute& attribute, std::size_t index, const Names& names, const StoredAs& stored)
    {
        for (const std::string& name : names) used_.insert(lower_case(name));
        const bool halves = stored.raw() && is_wide(attribute.type);
        const ScalarType type = halves ? ScalarType::u32 : stored.type;
        for (std::size_t k = 0; k < names.size(); ++k) {
            RecordField field = field_of(stored, index, 1);
            // The upper half has the sign.
            field.type = halves && attribute.type == ScalarType::i64 && k % 2 == 1 ? ScalarType::i32 : type;
            field.byte = k * (stored.raw() ? size_of(type) : size_of(attribute.type));
            properties.push_back({names[k], field});
        }
    }

    // Names of one property per component, or of two halves. Distinct from all others.
    Names names_of(const Attribute& attribute, bool halves, const std::string& ending) const
    {
        std::string base = field_name(attribute.name) + ending;
        if (has_a_meaning(lower_case(base))) base = "attribute_" + base;
        for (int number = 1;; ++number) {
            const std::string stem = number == 1 ? base : base + "_" + std::to_string(number);
            Names names;
            for (std::uint32_t c = 0; c < attribute.components; ++c) {
                const std::string name = attribute.components == 1 ? stem : stem + "_" + std::to_string(c);
                if (halves) {
                    names.push_back(name + "_low");
                    names.push_back(name + "_high");
                } else {
                    names.push_back(name);
                }
            }
            const bool free = std::none_of(names.begin(), names.end(), [&](const std::string& name) {
                return used_.count(lower_case(name)) || has_a_meaning(lower_case(name));
            });
            if (free) return names;
        }
    }

    WriteOptions options_;
    bool has_colours_ = false;
    std::set<std::string> used_;  // lower case
};

std::vector<RecordField> fields_of(const Plan& plan)
{
    std::vector<RecordField> fields;
    for (const Property& property : plan.properties) fields.push_back(property.field);
    return fields;
}

class PlyWriter final : public PointWriter {
public:
    PlyWriter(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options)
        : ascii_(options.ascii), plan_(path, cloud, options), records_(cloud, options, fields_of(plan_)), file_(path)
    {
        plan_.carried.metadata = cloud.metadata;
        add_grid(cloud, plan_.carried.metadata);
        comments_ = carried_comments(plan_.carried, plan_.notes);
        plan_.carried.metadata.clear();
        const std::string text = header();
        if (text.size() > longest_ply_header)
            throw Error(ErrorCode::invalid_argument, path,
                        "the cloud's attributes need a header of " + std::to_string(text.size()) +
                            " bytes, readers of PLY take at most " + std::to_string(longest_ply_header));
        file_.append(text);
    }

    void write(const PointBatch& batch) override { records_.append(batch, file_); }
    void finish() override
    {
        const std::string text = header();
        file_.rewrite(text.data(), text.size(), 0);
        file_.finish();
    }
    double position_error() const override { return records_.position_error(); }
    std::vector<std::string> notes() const override { return plan_.notes; }

private:
    // Its length does not depend on the number of points.
    std::string header() const
    {
        const std::string count = std::to_string(records_.points());
        std::string text = ascii_ ? "ply\nformat ascii 1.0\n" : "ply\nformat binary_little_endian 1.0\n";
        text += "comment pcm " + std::string(20 - count.size(), '.') + "\n";
        for (const std::string& line : comments_) text += "comment " + line + "\n";
        text += "element vertex " + count + "\n";
        for (const Property& property : plan_.properties)
            text += "property " + std::string(ply_name(property.field.type)) + " " + property.name + "\n";
        return text + "end_header\n";
    }

    bool ascii_;
    Plan plan_;
    RecordEncoder records_;
    OutputFile file_;
    std::vector<std::string> comments_;
};

}  // namespace

SurveyQuestions ply_questions(const FileInfo& cloud, const WriteOptions& options)
{
    SurveyQuestions questions;
    for (const Attribute& attribute : cloud.schema)
        questions.attributes.push_back(question_about(attribute, options.colour_bits, false));
    return questions;
}

std::unique_ptr<PointWriter> create_ply(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options)
{
    return std::make_unique<PlyWriter>(path, cloud, options);
}

}  // namespace pcm
