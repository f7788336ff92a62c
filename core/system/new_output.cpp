#include "pcm/system/new_output.h"

#include "pcm/system/error.h"
#include "pcm/system/output_path.h"

#include <cctype>

namespace pcm {

void check_output(const std::filesystem::path& file, bool overwrite)
{
    output_file(file);
    std::error_code ignored;
    if (!overwrite && std::filesystem::exists(file, ignored))
        throw Error(ErrorCode::exists, file, "the output exists already", "choose another name, or overwrite it");
}

std::string lower_extension(const std::filesystem::path& file)
{
    std::string extension = file.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

std::string csv_field(const std::string& text)
{
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + "\"";
}

}  // namespace pcm
