#include "pcm/system/renamed_error.h"

namespace pcm {

std::string renamed(std::string text, const std::filesystem::path& from, const std::filesystem::path& to)
{
    const std::string old = from.string(), name = to.string();
    if (old.empty()) return text;
    for (std::size_t at = 0; (at = text.find(old, at)) != std::string::npos; at += name.size())
        text.replace(at, old.size(), name);
    return text;
}

Error renamed(const Error& error, const std::filesystem::path& from, const std::filesystem::path& to)
{
    return Error(error.code(), renamed(error.path().string(), from, to), renamed(text_alone(error), from, to),
                 renamed(error.hint(), from, to));
}

std::string without_path(const Error& error)
{
    std::string what = error.what();
    const std::string path = error.path().string() + ": ";
    if (!error.path().empty() && what.compare(0, path.size(), path) == 0) what.erase(0, path.size());
    return what;
}

std::string text_alone(const Error& error)
{
    std::string text = without_path(error);
    if (const std::string hint = " (" + error.hint() + ")"; !error.hint().empty() && text.size() > hint.size())
        text.erase(text.size() - hint.size());
    return text;
}

}  // namespace pcm
