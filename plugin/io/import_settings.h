// What the user can set about importing: persistently in Tools > Options, and for one file in the dialog before
// opening.
//
// MeshLab shows that dialog whenever there are parameters for a file, and goes on with them also when it is cancelled,
// so by default only text files, whose layout may have to be said, have any. meshlabserver shows no dialog and reads no
// saved settings: there the defaults hold.
#pragma once

#include "pcm/io/text/text_layout.h"

#include <common/interfaces.h>

#include <cstdint>
#include <filesystem>

namespace pcm::host {

struct ImportSettings {
    std::uint64_t largest_layer = 1'000'000;  // a cloud of more points becomes a tree
    std::filesystem::path tree_folder;        // where such trees go; empty: beside the file
    TextLayout text;                          // what the user has said of a text file
};

// The persistent ones, for Tools > Options.
void add_global_settings(RichParameterList& parameters);

// The ones for one file; none when nothing is to be asked. Defaults are the persistent settings.
void add_file_settings(RichParameterList& parameters, const std::filesystem::path& file);

// From what MeshLab hands to open(): the parameters for the file, where there are any, before the persistent ones.
// Throws Error(invalid_argument) for columns that make no sense.
ImportSettings read_import_settings(const RichParameterList& parameters);

}  // namespace pcm::host
