#include "pcm/ops/shared/reading_arguments.h"

#include "pcm/io/writer.h"
#include "pcm/system/error.h"

namespace pcm::ops {
namespace {

std::string joined(const std::vector<std::string>& names)
{
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

char separator_of(const std::string& s)
{
    const char c = s == "space"               ? ' '
                   : s == "tab" || s == "\\t" ? '\t'
                   : s == "comma"             ? ','
                   : s == "semicolon"         ? ';'
                   : s.size() == 1            ? s[0]
                                              : '\0';
    if (c != ' ' && c != '\t' && c != ',' && c != ';')
        throw Error(ErrorCode::invalid_argument, {}, "'" + s + "' is not a column separator",
                    "use space, tab, comma or semicolon");
    return c;
}

}  // namespace

void ReadingArguments::declare(Arguments& arguments, std::optional<Face> only)
{
    const auto add = [&](const char* key, auto& variable) -> Argument& {
        Argument& argument = arguments.add(key, variable);
        if (only) argument.only(*only);
        return argument;
    };
    const char* const faults = "Bad input (an error by default)";
    add("skip_bad_lines", skip_bad_lines_)
        .group(faults)
        .label("Skip bad lines")
        .advanced()
        .help("Text, PTS, PTX: skip and count lines that are not points instead of refusing the file");
    add("skip_bad_files", skip_bad_files_)
        .group(faults)
        .label("Skip bad files")
        .advanced()
        .help("Skip and count files that cannot be opened; of those that fail later keep what was read");
    const char* const text = "Text files (detected by default)";
    add("columns", columns_)
        .group(text)
        .label("Columns")
        .advanced()
        .help("Text files: names of the columns, such as \"x y z intensity r g b\"; - skips a column")
        .without("detected");
    add("separator", separator_)
        .group(text)
        .label("Separator")
        .advanced()
        .help("Text files: space (any number of blanks), tab, comma, semicolon, or the character itself")
        .without("detected");
    add("skip_lines", skip_lines_)
        .group(text)
        .label("Header lines")
        .advanced()
        .help("Text files: header lines before the first point")
        .without("detected");
    add("colour_range", colour_range_)
        .group(text)
        .positive()
        .label("Range of colours")
        .advanced()
        .help("Text files: maximum value of a colour: 1, 255 or 65535")
        .without("detected");
    add("largest_coordinate", largest_coordinate_)
        .positive()
        .label("Largest coordinate")
        .advanced()
        .help(
            "Leave out points with a coordinate beyond this, such as no-data values of 3.4e38, which would leave no "
            "precision for the others; the number left out is reported")
        .without("none is left out");
}

void ReadingArguments::declare_ignore_crs(Arguments& arguments, std::optional<Face> only)
{
    Argument& argument =
        arguments.add("ignore_crs", ignore_crs_)
            .label("Ignore coordinate systems")
            .help(
                "Combine clouds whose coordinate systems, units or GPS times differ, with their numbers as they are; "
                "the first system is kept, and the differences are reported");
    if (only) argument.only(*only);
}

ReadOptions ReadingArguments::get(unsigned threads) const
{
    ReadOptions options;
    options.threads = threads;
    options.ignore_crs = ignore_crs_;
    options.skip_bad_lines = skip_bad_lines_;
    options.skip_bad_files = skip_bad_files_;
    if (!columns_.empty()) options.text.columns = parse_columns(columns_);
    if (!separator_.empty()) options.text.separator = separator_of(separator_);
    options.text.skip_lines = skip_lines_;
    if (colour_range_ && *colour_range_ != 1 && *colour_range_ != 255 && *colour_range_ != 65535)
        throw Error(ErrorCode::invalid_argument, {}, "the range of colours must be 1, 255 or 65535");
    options.text.colour_range = colour_range_;
    options.largest_coordinate = largest_coordinate_;
    return options;
}

void put_skipped(Result& result, const Skipped& skipped)
{
    result.values["lines_skipped"] = skipped.lines;
    result.values["files_skipped"] = skipped.files;
    result.values["files_incomplete"] = skipped.incomplete_files;
}

std::vector<ResultKey> with_skipped_keys(std::vector<ResultKey> keys)
{
    for (const ResultKey& key : {ResultKey{"lines_skipped", "count", "", "lines that are not points"},
                                 ResultKey{"files_skipped", "count", "", "files that could not be opened"},
                                 ResultKey{"files_incomplete", "count", "", "files that were read up to a fault"}})
        keys.push_back(key);
    return keys;
}

std::string readable_text() { return joined(readable_extensions()); }
std::string writable_text() { return joined(writable_extensions()); }

}  // namespace pcm::ops
