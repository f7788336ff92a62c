#include "pcm/io/las/las_target.h"

#include "pcm/io/las/las_layout.h"
#include "pcm/system/error.h"

#include <algorithm>

namespace pcm::las {
namespace {

bool is_signed(ScalarType type)
{
    return type == ScalarType::i8 || type == ScalarType::i16 || type == ScalarType::i32 || type == ScalarType::i64;
}

// Whether type `to` can represent every value of type `from`.
bool widens(ScalarType from, ScalarType to)
{
    if (from == to) return true;
    if (is_float(to)) {
        if (is_float(from)) return size_of(from) <= size_of(to);
        return size_of(from) < size_of(to);
    }
    if (is_float(from)) return false;
    if (is_signed(from) && !is_signed(to)) return false;
    return size_of(from) < size_of(to);
}

bool names_all_of(const Schema& cloud, const Schema& fields)
{
    return std::all_of(fields.begin(), fields.end(),
                       [&](const Attribute& f) { return cloud.find(f.name).has_value(); });
}

bool has_all_of(const Schema& cloud, const Schema& fields)
{
    return std::all_of(fields.begin(), fields.end(), [&](const Attribute& f) {
        const auto i = cloud.find(f.name);
        return i && cloud[*i].type == f.type && cloud[*i].components == f.components && cloud[*i].scale == f.scale;
    });
}

unsigned format_of(const std::vector<std::byte>& header)
{
    return load<std::uint8_t>(&header[header::point_format]) & 0x3Fu;
}

// The source's format, if the cloud has a source and still has all fields of that format.
std::optional<unsigned> source_format(const FileInfo& cloud)
{
    const auto* const header = source_header(cloud);
    if (!header) return std::nullopt;
    const unsigned format = format_of(*header);
    if (format >= format_count || !names_all_of(cloud.schema, fields_of_format(format).schema)) return std::nullopt;
    return format;
}

// Fields of formats 6 to 10 only: a cloud that has them next to the fields of an older format comes from several files.
bool has_extended_fields(const Schema& schema)
{
    return schema.find("scanner_channel") || schema.find("overlap") || schema.find("scan_angle");
}

class Chooser {
public:
    Chooser(const FileInfo& cloud, const WriteOptions& options)
        : cloud_(cloud), survey_(options.survey.get()), most_(options.las_version.value_or(4))
    {
    }

    bool allows(unsigned format) const { return first_minor(format) <= most_; }

    // Whether no value needs more bits than its field of this format has.
    bool holds_values(unsigned format) const
    {
        const Fields native = fields_of_format(format);
        for (std::size_t i = 0; i < native.fields.size(); ++i) {
            const auto k = cloud_.schema.find(native.schema[i].name);
            const ValueSurvey* const known = k && survey_ ? survey_->of(*k) : nullptr;
            if (native.fields[i].mask && known && !known->within(0, native.fields[i].mask)) return false;
        }
        return true;
    }

    unsigned best() const
    {
        Score best = score(0);
        for (unsigned format = 1; format < format_count; ++format) {
            if (!allows(format)) continue;
            const Score next = score(format);
            if (next.better_than(best)) best = next;
        }
        return best.format;
    }

private:
    struct Score {
        unsigned format = 0;
        bool whole = false;
        std::size_t carried = 0, named = 0;

        bool better_than(const Score& other) const
        {
            if (whole != other.whole) return whole;
            if (carried != other.carried) return carried > other.carried;
            if (named != other.named) return named > other.named;
            return record_bytes[format] < record_bytes[other.format];
        }
    };

    Score score(unsigned format) const
    {
        const Fields native = fields_of_format(format);
        // A cloud from LAS has all fields of its format, and they can hold its values.
        Score score{format, has_all_of(cloud_.schema, native.schema) && holds_values(format)};
        for (std::size_t k = 0; k < cloud_.schema.size(); ++k) {
            const Attribute& attribute = cloud_.schema[k];
            const auto i = native.schema.find(attribute.name);
            score.named += i.has_value();
            const ValueSurvey* const known = survey_ ? survey_->of(k) : nullptr;
            if (!i || !exact_conversion(attribute, native.schema[*i], native.fields[*i].mask, known)) continue;
            // 8-bit classes are common; the old formats have 5 bits.
            if (attribute.name == attribute_name::classification && native.fields[*i].mask && !score.whole && !known)
                continue;
            ++score.carried;
        }
        return score;
    }

    const FileInfo& cloud_;
    const Survey* survey_;
    unsigned most_;
};

}  // namespace

std::optional<Conversion> exact_conversion(const Attribute& attribute, const Attribute& field, unsigned mask,
                                           const ValueSurvey* known)
{
    if (attribute.components != field.components) return std::nullopt;
    if (attribute.name == attribute_name::rgb && attribute.type == ScalarType::u8 && attribute.scale == 1 &&
        attribute.offset == 0)
        return Conversion::colours;
    if (attribute.scale != field.scale || attribute.offset != field.offset) return std::nullopt;
    if (mask && known && !known->within(0, mask)) return std::nullopt;
    if (attribute.type == field.type) return Conversion::none;
    if (!mask && widens(attribute.type, field.type)) return Conversion::widened;
    return std::nullopt;
}

const std::vector<std::byte>* source_header(const FileInfo& cloud)
{
    const auto found = std::find_if(cloud.metadata.begin(), cloud.metadata.end(), [](const Metadata& block) {
        return block.key == header_key && block.value.size() >= header::size_1_0;
    });
    return found == cloud.metadata.end() ? nullptr : &found->value;
}

Target choose_target(const std::filesystem::path& path, const FileInfo& cloud, const WriteOptions& options)
{
    if (options.las_version && *options.las_version > 4)
        throw Error(ErrorCode::invalid_argument, path,
                    "LAS 1." + std::to_string(*options.las_version) + " was requested; 1.0 to 1.4 can be written");
    const Chooser chooser(cloud, options);
    const auto own = source_format(cloud);
    Target target;
    target.format = own && chooser.allows(*own) && chooser.holds_values(*own) ? *own : chooser.best();
    target.minor_is_asked = options.las_version.has_value();
    const auto* const header = source_header(cloud);
    const unsigned source_minor = header ? load<std::uint8_t>(&(*header)[header::version_minor]) : 2u;
    target.minor = options.las_version.value_or(std::max(std::min(source_minor, 4u), first_minor(target.format)));
    return target;
}

SurveyQuestions questions_about(const FileInfo& cloud, const WriteOptions& options)
{
    SurveyQuestions questions;
    const auto own = source_format(cloud);
    // Values that came out of the fields of a format fit them again.
    const bool stays = own && first_minor(*own) <= options.las_version.value_or(4) &&
                       (is_extended(*own) || !has_extended_fields(cloud.schema));
    for (const Attribute& attribute : cloud.schema) {
        const bool shown = attribute.name == attribute_name::intensity || attribute.name == attribute_name::rgb;
        Question question = Question::none;
        // Bits of formats 0 to 5; those of the others are as many or more.
        const Fields bits = fields_of_format(0);
        const auto place = bits.schema.find(attribute.name);
        if (!stays && place && bits.fields[*place].mask) question = Question::range;
        if (!stays && attribute.name == "scanner_channel") question = Question::range;
        if (shown && attribute.type != ScalarType::u16 && attribute.type != ScalarType::u8) question = Question::range;
        questions.attributes.push_back(question);
    }
    return questions;
}

}  // namespace pcm::las
