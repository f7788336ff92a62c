#include "pcm/io/pcd/pcd_writer.h"

#include "pcm/cloud/nearest_float.h"
#include "pcm/io/file_text.h"
#include "pcm/io/pcd/pcd_header.h"
#include "pcm/io/records/carried_comments.h"
#include "pcm/io/records/line_words.h"
#include "pcm/io/records/record_encoder.h"
#include "pcm/io/records/stored_values.h"
#include "pcm/system/output_file.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace pcm {
namespace {

struct Field {
    std::string name;
    char kind = 'F';
    std::size_t size = 4;
    std::uint32_t count = 1;
};

char kind_of(ScalarType type)
{
    switch (type) {
        case ScalarType::f32:
        case ScalarType::f64:
            return 'F';
        case ScalarType::i8:
        case ScalarType::i16:
        case ScalarType::i32:
        case ScalarType::i64:
            return 'I';
        default:
            return 'U';
    }
}

// Names with a special meaning for pcd_reader.
bool has_a_meaning(const std::string& lower_name)
{
    static constexpr std::string_view names[] = {"x",        "y",        "z",        "rgb", "rgba",  "red", "green",
                                                 "blue",     "r",        "g",        "b",   "nx",    "ny",  "nz",
                                                 "normal_x", "normal_y", "normal_z", "_",   "normal"};
    return std::find(std::begin(names), std::end(names), lower_name) != std::end(names);
}

// A whole number near the middle of the coordinates, exact as a float: VIEWPOINT's readers have floats.
double shift_of(double least, double most)
{
    const double middle = least + (most - least) / 2, half = (most - least) / 2;
    if (!std::isfinite(middle) || std::fabs(middle) <= 2 * half) return 0;
    const double unit = std::max(1.0, std::pow(10.0, std::floor(std::log10(std::max(half, 1.0)))));
    return nearest_float(std::round(middle / unit) * unit);
}

class Plan {
public:
    Plan(const FileInfo& cloud, const WriteOptions& options) : options_(options)
    {
        const bool stay = cloud.position_type == ScalarType::f32 && !cloud.grid;
        const bool fit = !stay && !options.float_positions && options.survey && options.survey->floats_hold_positions;
        if (options.float_positions && !stay) {
            carried.shift = shift(cloud);
            if (*carried.shift != Vec3d{0, 0, 0})
                notes.push_back("positions are floats relative to " + exact(*carried.shift) +
                                ", which is in VIEWPOINT: other programs have to add it");
        } else if (fit && cloud.grid) {
            carried.shift = Vec3d{0, 0, 0};
            notes.emplace_back(
                "positions are floats (F 4), as PCL reads them: each the nearest to its point of the cloud's grid, "
                "which "
                "is found again from it");
        }
        const ScalarType position = stay || fit || options.float_positions ? ScalarType::f32 : ScalarType::f64;
        for (std::size_t a = 0; a < 3; ++a) {
            fields.push_back({std::string(1, "xyz"[a]), 'F', size_of(position), 1});
            records.push_back(RecordField::axis(a, position));
            if (carried.shift) records.back().shift = (*carried.shift)[a];
        }
        if (position == ScalarType::f64)
            notes.push_back(
                "positions are in double precision (F 8), because floats do not hold them: PCL's point types and "
                "Open3D read F 4 alone, and take these for zeros. Float positions (--float-positions) are for them");
        for (std::size_t i = 0; i < cloud.schema.size(); ++i) i += add(cloud.schema, i);
    }

    std::vector<Field> fields;
    std::vector<RecordField> records;
    Carried carried;
    std::vector<std::string> notes;

private:
    using Names = std::vector<std::string>;

    static bool is_plain(const Attribute& attribute)
    {
        return attribute.scale == 1 && attribute.offset == 0 && attribute.description.empty();
    }

    Vec3d shift(const FileInfo& cloud) const
    {
        Vec3d shift{0, 0, 0};
        Box3d box = options_.survey ? options_.survey->box : Box3d();
        if (box.empty() && cloud.promised_box) box = *cloud.promised_box;
        for (std::size_t a = 0; !box.empty() && a < 3; ++a) shift[a] = shift_of(box.min[a], box.max[a]);
        return shift;
    }

    StoredAs stored(const Attribute& attribute, std::size_t index) const
    {
        const ValueSurvey* const known = options_.survey ? options_.survey->of(index) : nullptr;
        if (attribute.name == attribute_name::rgb && attribute.components == 3)
            return stored_colours(attribute, known, options_.colour_bits);
        StoredAs stored = stored_values(attribute, known);
        // PCL's points and Open3D have these as floats alone.
        const bool intensity = attribute.name == attribute_name::intensity && attribute.components == 1;
        const bool normal = attribute.name == attribute_name::normal && attribute.components == 3;
        if ((intensity || normal) && stored.type != ScalarType::f32) {
            const bool integer = attribute.type != ScalarType::f64 && attribute.type != ScalarType::f32;
            stored.rounded = !(integer && stored.raw() && size_of(attribute.type) <= 2);
            stored.source = RecordField::Source::value;
            stored.type = ScalarType::f32;
        }
        return stored;
    }

    // Returns how many of the following attributes were included.
    std::size_t add(const Schema& schema, std::size_t index)
    {
        const Attribute& attribute = schema[index];
        const StoredAs as = stored(attribute, index);
        const bool colours = attribute.name == attribute_name::rgb && attribute.components == 3;
        Names names;
        bool plain = is_plain(attribute) && as.raw();
        std::size_t more = 0;
        if (colours && as.type == ScalarType::u8) {
            more = add_packed(schema, index, as);
            names = {fields.back().name};
        } else if (colours || (attribute.name == attribute_name::normal && attribute.components == 3)) {
            names = colours ? Names{"red", "green", "blue"} : Names{"normal_x", "normal_y", "normal_z"};
            for (std::uint32_t c = 0; c < 3; ++c) {
                RecordField field = field_of(as, index, 1);
                field.byte = c * size_of(attribute.type);
                add_field(names[c], field);
            }
            if (colours)
                notes.push_back("colours of type " + std::string(name_of(attribute.type)) +
                                " are kept as fields red, green, blue: PCL shows packed colours of 8 bits");
        } else {
            names = {name_of_field(attribute, "")};
            plain = plain && pcd_attribute_name(names[0]) == attribute.name;
            add_field(names[0], field_of(as, index, attribute.components));
        }
        if (as.rounded && colours && options_.colour_bits)
            notes.push_back("colours of type " + std::string(name_of(attribute.type)) + " are rounded to 8 bits");
        else if (as.rounded)
            add_exact(attribute, index, names);
        else if (!plain)
            carried.attributes.push_back({names[0], attribute, as.step});
        return more;
    }

    void add_field(const std::string& name, const RecordField& record)
    {
        fields.push_back({name, kind_of(record.type), size_of(record.type), record.count});
        records.push_back(record);
        used_.insert(lower_case(name));
    }

    // As PCL writes it: the bits stored as a float; in text as an integer, because floats would lose bits.
    std::size_t add_packed(const Schema& schema, std::size_t index, const StoredAs& as)
    {
        RecordField packed{RecordField::Source::packed_rgb, ScalarType::u32, index, 0, 1, {}, as.factor};
        bool with_alpha = index + 1 < schema.size() && !as.rounded;
        if (with_alpha) {
            const Attribute& alpha = schema[index + 1];
            with_alpha =
                alpha.name == "alpha" && alpha.type == ScalarType::u8 && alpha.components == 1 && is_plain(alpha);
        }
        if (with_alpha) {
            packed.alpha = index + 1;
            used_.insert("alpha");
        }
        add_field(with_alpha ? "rgba" : "rgb", packed);
        fields.back().kind = with_alpha || options_.ascii ? 'U' : 'F';
        return with_alpha;
    }

    // The raw numbers, after fields that have them rounded.
    void add_exact(const Attribute& attribute, std::size_t index, const Names& rounded)
    {
        const bool colours = attribute.name == attribute_name::rgb && attribute.components == 3;
        const bool scaled = !colours && (attribute.scale != 1 || attribute.offset != 0);
        const std::string name = name_of_field(attribute, scaled ? "_raw" : "_exact");
        add_field(name, RecordField::scalars(index, 0, attribute.type, attribute.components));
        carried.attributes.push_back({name, attribute, 0});
        carried.repeated.push_back({rounded[0], static_cast<std::uint32_t>(rounded.size()), name});
        if (colours)
            notes.push_back("colours of type " + std::string(name_of(attribute.type)) +
                            " are written packed with 8 bits, which PCL shows, and exactly, as " + name +
                            ": 8 colour bits leave the exact ones out, 16 those of 8 bits");
        else if (scaled)
            notes.push_back("'" + attribute.name + "' is written as values, " + rounded[0] + ", and as raw numbers, " +
                            name + ", without its scale and offset");
        else
            notes.push_back("'" + attribute.name + "' of type " + std::string(name_of(attribute.type)) +
                            " is written as floats, which PCL's points and Open3D read, and exactly, as " + name);
    }

    std::string name_of_field(const Attribute& attribute, const std::string& ending) const
    {
        std::string base = field_name(attribute.name) + ending;
        if (has_a_meaning(lower_case(base))) base = "attribute_" + base;
        std::string name = base;
        for (int number = 2; used_.count(lower_case(name)); ++number) name = base + "_" + std::to_string(number);
        return name;
    }

    WriteOptions options_;
    std::set<std::string> used_;  // lower case
};

// The source's viewpoint if it is valid: a translation and a quaternion.
std::string viewpoint_of(std::vector<Metadata>& metadata)
{
    const auto found = std::find_if(metadata.begin(), metadata.end(),
                                    [](const Metadata& block) { return block.key == "pcd.viewpoint"; });
    std::string viewpoint = "0 0 0 1 0 0 0";
    if (found == metadata.end()) return viewpoint;
    const std::string text(reinterpret_cast<const char*>(found->value.data()), found->value.size());
    LineWords words(text);
    std::string_view word;
    double value = 0;
    std::size_t numbers = 0;
    while (words.next_number(ScalarType::f64, reinterpret_cast<std::byte*>(&value), word) && std::isfinite(value))
        ++numbers;
    if (numbers != 7 || !words.at_end() || printable_name(text) != text) return viewpoint;
    metadata.erase(found);
    return text;
}

class PcdWriter final : public PointWriter {
public:
    PcdWriter(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options)
        : ascii_(options.ascii), plan_(cloud, options), records_(cloud, options, plan_.records), file_(path)
    {
        Carried& carried = plan_.carried;
        carried.metadata = cloud.metadata;
        if (carried.shift && *carried.shift != Vec3d{0, 0, 0})
            viewpoint_ = exact(*carried.shift) + " 1 0 0 0";  // the source's own stays among the metadata
        else
            viewpoint_ = viewpoint_of(carried.metadata);
        add_grid(cloud, carried.metadata);
        comments_ = carried_comments(carried, plan_.notes);
        carried.metadata.clear();
        const std::string text = header();
        if (text.size() > longest_pcd_header || records_.record_bytes() > most_pcd_record_bytes)
            throw Error(ErrorCode::invalid_argument, path,
                        "the cloud's attributes need a header of " + std::to_string(text.size()) +
                            " bytes and points of " + std::to_string(records_.record_bytes()) +
                            ", readers take at most " + std::to_string(longest_pcd_header) + " and " +
                            std::to_string(most_pcd_record_bytes));
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
        std::string text = "# .PCD v0.7 - Point Cloud Data file format\n";
        text += "# pcm " + std::string(2 * (20 - count.size()) + 1, '.') + "\n";
        for (const std::string& line : comments_) text += "# " + line + "\n";
        std::string names, sizes, kinds, counts;
        for (const Field& field : plan_.fields) {
            names += " " + field.name;
            sizes += " " + std::to_string(field.size);
            kinds += std::string(" ") + field.kind;
            counts += " " + std::to_string(field.count);
        }
        text += "VERSION 0.7\nFIELDS" + names + "\nSIZE" + sizes + "\nTYPE" + kinds + "\nCOUNT" + counts + "\n";
        text += "WIDTH " + count + "\nHEIGHT 1\nVIEWPOINT " + viewpoint_ + "\nPOINTS " + count + "\n";
        return text + (ascii_ ? "DATA ascii\n" : "DATA binary\n");
    }

    bool ascii_;
    Plan plan_;
    RecordEncoder records_;
    OutputFile file_;
    std::string viewpoint_;
    std::vector<std::string> comments_;
};

}  // namespace

SurveyQuestions pcd_questions(const FileInfo& cloud, const WriteOptions& options)
{
    SurveyQuestions questions;
    for (const Attribute& attribute : cloud.schema)
        questions.attributes.push_back(question_about(attribute, options.colour_bits, true));
    const bool stay = cloud.position_type == ScalarType::f32 && !cloud.grid;
    questions.box = options.float_positions && !stay;
    questions.floats = !options.float_positions && !stay;
    return questions;
}

std::unique_ptr<PointWriter> create_pcd(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options)
{
    return std::make_unique<PcdWriter>(path, cloud, options);
}

}  // namespace pcm
