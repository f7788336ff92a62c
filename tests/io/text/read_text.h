// Texts read as point clouds, for tests.
#pragma once

#include "tests/io/bytes.h"

#include <string>
#include <vector>

namespace pcm::test {

inline Whole read_text(const std::string& text, const char* name = "a.xyz", const TextLayout& layout = {},
                       std::size_t batch_points = default_batch_points)
{
    TemporaryFolder folder;
    ReadOptions options;
    options.text = layout;
    return read_whole(*open_reader(write_file(folder / name, text), options), batch_points);
}

inline Error refusal(const std::string& text, const char* name = "a.xyz", const TextLayout& layout = {})
{
    TemporaryFolder folder;
    const auto path = write_file(folder / name, text);
    ReadOptions options;
    options.text = layout;
    const Error error = error_of([&] { read_whole(*open_reader(path, options)); });
    EXPECT_TRUE(layout.columns.empty() ? mentions(error.what(), path.string()) : true) << error.what();
    return error;
}

inline std::vector<std::string> notes_after(const std::string& text, const char* name)
{
    TemporaryFolder folder;
    const auto reader = open_reader(write_file(folder / name, text));
    read_whole(*reader);
    return reader->info().notes;
}

// Names and types of a schema: "intensity:u16 rgb:u8x3".
inline std::string names_of(const Schema& schema)
{
    std::string text;
    for (const Attribute& a : schema)
        text += (text.empty() ? "" : " ") + a.name + ":" + std::string(name_of(a.type)) +
                (a.components > 1 ? "x" + std::to_string(a.components) : "");
    return text;
}

}  // namespace pcm::test
