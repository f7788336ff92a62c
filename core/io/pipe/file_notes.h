// Notes about many files in a few lines.
#pragma once

#include "pcm/system/error.h"
#include "pcm/system/text.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace pcm {

// Notes of many files: equal ones are merged.
class FileNotes {
public:
    static constexpr std::size_t max_notes = 40;   // further ones are only counted
    static constexpr std::size_t named_files = 3;  // per note; further files are only counted

    explicit FileNotes(std::size_t files) : files_(files) {}

    void add(const std::string& text, const std::filesystem::path& file)
    {
        const auto [known, is_new] = index_.try_emplace(text, notes_.size());
        if (is_new) {
            if (notes_.size() == max_notes) {
                index_.erase(known);
                ++unnamed_;
                return;
            }
            notes_.push_back({text, {}, 0});
        }
        Note& note = notes_[known->second];
        if (note.names.size() < named_files) note.names.push_back(name_of(file));
        ++note.count;
    }
    void add(std::string text) { general_.push_back(std::move(text)); }

    static std::string name_of(const std::filesystem::path& file)
    {
        const std::filesystem::path name = file.filename().empty() ? file.parent_path().filename() : file.filename();
        return name.string();
    }
    // "a.las, b.las, c.las and 7 more"
    static std::string list_of(const std::vector<std::string>& names, std::size_t count)
    {
        std::string text;
        for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
        if (count > names.size()) text += " and " + grouped(count - names.size()) + " more";
        return text;
    }
    // "LAS (3); PLY (1)"
    static std::string list_of(const std::map<std::string, std::size_t>& counted)
    {
        std::string text;
        for (const auto& [name, count] : counted)
            text += (text.empty() ? "" : "; ") + name + " (" + grouped(count) + ")";
        return text;
    }
    std::vector<std::string> take()
    {
        std::vector<std::string> all;
        for (const Note& note : notes_)
            all.push_back(files_ == 1 ? note.text : list_of(note.names, note.count) + ": " + note.text);
        if (unnamed_) all.push_back(grouped(unnamed_) + " more notes about files are not repeated here");
        all.insert(all.end(), general_.begin(), general_.end());
        return all;
    }

private:
    struct Note {
        std::string text;
        std::vector<std::string> names;
        std::size_t count;
    };
    std::size_t files_;
    std::vector<Note> notes_;
    std::map<std::string, std::size_t> index_;
    std::uint64_t unnamed_ = 0;
    std::vector<std::string> general_;
};

// Note about inputs without which the others were read; there is at least one.
inline std::string note_of_left_out(const std::vector<Error>& errors)
{
    std::vector<std::string> names;
    for (std::size_t i = 0; i < std::min(errors.size(), FileNotes::named_files); ++i)
        names.push_back(FileNotes::name_of(errors[i].path()));
    const std::string count = grouped(errors.size()) + (errors.size() == 1 ? " input" : " inputs");
    return count + " cannot be read and" + (errors.size() == 1 ? " is" : " are") +
           " left out: " + FileNotes::list_of(names, errors.size()) + "; the first because " + errors[0].what();
}

}  // namespace pcm
