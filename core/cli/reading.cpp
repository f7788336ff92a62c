#include "pcm/cli/reading.h"

#include "pcm/system/error.h"

namespace pcm::cli {

void ReadingOptions::add_to(Options& options)
{
    const char* const group = "Text files (detected by default)";
    options.option("--columns", columns_, "Names of the columns, such as \"x y z intensity r g b\"; - skips a column")
        .group(group);
    options
        .option("--separator", separator_,
                "space (any number of blanks), tab, comma, semicolon, or the character itself")
        .group(group);
    options.option("--skip-lines", skip_lines_, "Header lines before the first point").group(group);
    options.option("--colour-range", colour_range_, "Maximum value of a colour: 1, 255 or 65535").group(group);
    options
        .option("--largest-coordinate", largest_coordinate_,
                "Leave out points with a coordinate beyond this, such as no-data values; how many is reported")
        .positive();
}

ReadOptions ReadingOptions::get(unsigned threads) const
{
    ReadOptions options;
    options.threads = threads;
    if (!columns_.empty()) options.text.columns = parse_columns(columns_);
    if (!separator_.empty()) {
        const std::string& s = separator_;
        const char c = s == "space"               ? ' '
                       : s == "tab" || s == "\\t" ? '\t'
                       : s == "comma"             ? ','
                       : s == "semicolon"         ? ';'
                       : s.size() == 1            ? s[0]
                                                  : '\0';
        if (c != ' ' && c != '\t' && c != ',' && c != ';')
            throw Error(ErrorCode::invalid_argument, {}, "'" + s + "' is not a column separator",
                        "use space, tab, comma or semicolon");
        options.text.separator = c;
    }
    options.text.skip_lines = skip_lines_;
    if (colour_range_ && *colour_range_ != 1 && *colour_range_ != 255 && *colour_range_ != 65535)
        throw Error(ErrorCode::invalid_argument, {}, "--colour-range must be 1, 255 or 65535");
    options.text.colour_range = colour_range_;
    options.largest_coordinate = largest_coordinate_;
    return options;
}

}  // namespace pcm::cli
