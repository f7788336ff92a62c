#include "pcm/system/text_file.h"

#include "pcm/system/error.h"
#include "pcm/system/file.h"
#include "pcm/system/text.h"

namespace pcm {

std::string read_text_file(const std::filesystem::path& file, const std::string& what, std::uint64_t most_bytes)
{
    const File input(file, File::Mode::read);
    const std::uint64_t size = input.size();
    if (size > most_bytes)
        throw Error(ErrorCode::bad_format, file,
                    "this file of " + bytes_text(size) + " is not " + what + ": such a file has at most " +
                        bytes_text(most_bytes));
    std::string text(static_cast<std::size_t>(size), '\0');
    text.resize(input.read_some_at(text.data(), text.size(), 0));  // it may have become shorter
    return text;
}

}  // namespace pcm
